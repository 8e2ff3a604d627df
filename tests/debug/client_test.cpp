// What every packet of the protocol answers and does.
#include "debug/client.h"

#include <gtest/gtest.h>

#include "debug/monitor.h"
#include "fake_target.h"

namespace capsoc::debug::test {
namespace {

class ClientTest : public ::testing::Test {
 protected:
  /// The payload of the last answer to a packet, "(none)" without one.
  std::string ask(const std::string& payload) {
    request = client.handle({Arrival::Kind::packet, payload});
    return last_payload();
  }
  std::string last_payload() {
    PacketReader reader;
    std::string last = "(none)";
    for (const Arrival& a : reader.feed(client.take_output()))
      if (a.kind == Arrival::Kind::packet) last = a.payload;
    return last;
  }
  FakeTarget target;
  Client client{target};
  Request request;
};

TEST_F(ClientTest, SaysWhatItCan) {
  const std::string features = ask("qSupported:multiprocess+;swbreak+;hwbreak+");
  for (const char* feature :
       {"PacketSize=4000", "QStartNoAckMode+", "qXfer:features:read+", "qXfer:memory-map:read+",
        "qXfer:threads:read+", "vContSupported+", "swbreak+", "hwbreak+"})
    EXPECT_NE(features.find(feature), std::string::npos) << feature;
  EXPECT_EQ(ask("vCont?"), "vCont;c;C;s;S;r;t");
  EXPECT_EQ(ask("vMustReplyEmpty"), "");
  EXPECT_EQ(ask("qTStatus"), "");
  EXPECT_EQ(ask("qAttached"), "1");
}

TEST_F(ClientTest, RegistersThatTheProcessorDoesNotHaveAreNowhere) {
  constexpr unsigned basepri = 20, faultmask = 21, control = 22;
  target.missing = {basepri, faultmask};
  for (unsigned i = 0; i < registers.size(); ++i) target.values[i] = i + 1;
  const std::string xml = ask("qXfer:features:read:target.xml:0,4000");
  EXPECT_EQ(xml.find("basepri"), std::string::npos);
  EXPECT_EQ(xml.find("faultmask"), std::string::npos);
  EXPECT_NE(xml.find("name=\"control\" bitsize=\"8\" regnum=\"31\""), std::string::npos)
      << "the others keep their numbers";
  const std::string all = ask("g");
  ASSERT_EQ(all.size(), 156U);
  EXPECT_EQ(all.substr(152), "1417") << "primask, control";
  EXPECT_EQ(ask("p1d"), "E01") << "basepri";
  EXPECT_EQ(ask("P1d=00"), "E01");
  EXPECT_EQ(ask("p1f"), "17");
  EXPECT_EQ(ask("G" + all.substr(0, 154) + "18"), "OK");
  EXPECT_EQ(target.values[control], 0x18U);
  EXPECT_EQ(target.values[basepri], basepri + 1U);
}

TEST_F(ClientTest, AcknowledgesUntilToldNotTo) {
  client.handle({Arrival::Kind::packet, "qC"});
  EXPECT_EQ(client.take_output(), "+$QC1#c5");
  client.handle({Arrival::Kind::nak});
  EXPECT_EQ(client.take_output(), "$QC1#c5");
  client.handle({Arrival::Kind::damaged});
  EXPECT_EQ(client.take_output(), "-");
  EXPECT_EQ(ask("QStartNoAckMode"), "OK");
  client.handle({Arrival::Kind::packet, "qC"});
  EXPECT_EQ(client.take_output(), "$QC1#c5");
  client.handle({Arrival::Kind::damaged});
  EXPECT_EQ(client.take_output(), "");
}

TEST_F(ClientTest, RegistersAreEightyBytesInTheOrderOfTheDescription) {
  for (unsigned i = 0; i < registers.size(); ++i) target.values[i] = i + 1;
  const std::string all = ask("g");
  ASSERT_EQ(all.size(), 160U);
  EXPECT_EQ(all.substr(0, 8), "01000000");
  EXPECT_EQ(all.substr(2 * 64, 8), "11000000") << "xpsr";
  EXPECT_EQ(all.substr(2 * 68, 8), "12000000") << "msp";
  EXPECT_EQ(all.substr(2 * 79, 2), "17") << "control";
  EXPECT_EQ(ask("p19"), "11000000");
  EXPECT_EQ(ask("p1a"), "12000000");
  EXPECT_EQ(ask("p1f"), "17");
  EXPECT_EQ(ask("p10"), "E01");
  EXPECT_EQ(ask("p20"), "E01");
  EXPECT_EQ(ask("P0=efbeadde"), "OK");
  EXPECT_EQ(target.values[0], 0xDEADBEEFU);
  EXPECT_EQ(ask("P0=efbe"), "E01");
  EXPECT_EQ(ask("G" + all), "OK");
  EXPECT_EQ(target.values[0], 1U);
  EXPECT_EQ(ask("G00"), "E01");
}

// GDB's documentation, "ARM Features": org.gnu.gdb.arm.vfp has d0 to d15 and fpscr.
TEST_F(ClientTest, AnFpuHasDoublePrecisionRegistersOfTwoSinglesEach) {
  EXPECT_EQ(ask("qXfer:features:read:target.xml:0,4000").find("vfp"), std::string::npos);
  target.has_fpu = true;
  for (unsigned i = 0; i < registers.size(); ++i) target.values[i] = i + 1;
  const std::string xml = ask("qXfer:features:read:target.xml:0,4000");
  EXPECT_NE(xml.find("org.gnu.gdb.arm.vfp"), std::string::npos);
  EXPECT_NE(xml.find("name=\"d15\" bitsize=\"64\" regnum=\"47\" type=\"ieee_double\""),
            std::string::npos);
  EXPECT_NE(xml.find("name=\"fpscr\" bitsize=\"32\" regnum=\"48\""), std::string::npos);
  EXPECT_EQ(xml.find("\"s0\""), std::string::npos) << "GDB makes them of the others";
  const std::string all = ask("g");
  ASSERT_EQ(all.size(), 160U + 33 * 8);
  EXPECT_EQ(all.substr(160, 16), "1800000019000000") << "s0, s1";
  EXPECT_EQ(ask("p20"), "1800000019000000");
  EXPECT_EQ(ask("p2f"), "3600000037000000");
  EXPECT_EQ(ask("p30"), "38000000");
  EXPECT_EQ(ask("p31"), "E01");
  EXPECT_EQ(ask("P21=0403020108070605"), "OK");
  EXPECT_EQ(target.values[first_fpu_register + 2], 0x01020304U);
  EXPECT_EQ(target.values[first_fpu_register + 3], 0x05060708U);
  EXPECT_EQ(ask("P21=04030201"), "E01");
  EXPECT_EQ(ask("P30=00004001"), "OK");
  EXPECT_EQ(target.values[first_fpu_register + fpu_singles], 0x01400000U);
}

TEST_F(ClientTest, DescriptionNamesBothFeatures) {
  const std::string xml = ask("qXfer:features:read:target.xml:0,4000");
  EXPECT_EQ(xml.front(), 'l');
  EXPECT_NE(xml.find("org.gnu.gdb.arm.m-profile"), std::string::npos);
  EXPECT_NE(xml.find("org.gnu.gdb.arm.m-system"), std::string::npos);
  EXPECT_NE(xml.find("name=\"xpsr\" bitsize=\"32\" regnum=\"25\""), std::string::npos);
  EXPECT_NE(xml.find("name=\"control\" bitsize=\"8\" regnum=\"31\""), std::string::npos);
  std::string pieces;
  for (unsigned offset = 0;; offset += 100) {
    const std::string piece =
        ask("qXfer:features:read:target.xml:" +
            to_hex(std::string{static_cast<char>(offset >> 8), static_cast<char>(offset)}) + ",64");
    pieces += piece.substr(1);
    if (piece.front() == 'l') break;
    ASSERT_LT(offset, 10000U);
  }
  EXPECT_EQ(pieces, xml.substr(1));
  EXPECT_EQ(ask("qXfer:features:read:other.xml:0,100"), "E00");
}

TEST_F(ClientTest, MemoryIsWrittenAndReadInBothForms) {
  EXPECT_EQ(ask("M20000010,3:010203"), "OK");
  EXPECT_EQ(ask("m20000010,4"), "01020300");
  EXPECT_EQ(ask(std::string("X20000010,2:\x7f#", 14)), "OK");
  EXPECT_EQ(ask("m20000010,2"), "7f23");
  EXPECT_EQ(ask("X20000010,0:"), "OK");
  EXPECT_EQ(ask("X20000010,3:a"), "E01");
  EXPECT_EQ(ask("m10000000,4"), "E0e");
  EXPECT_EQ(ask("M10000000,1:00"), "E0e");
  EXPECT_EQ(ask("m2000fffe,8"), "0000") << "as far as there is memory";
  EXPECT_EQ(ask("m,"), "E01");
}

TEST_F(ClientTest, StopPointsGoWithTheirOwner) {
  EXPECT_EQ(ask("Z0,100,2"), "OK");
  EXPECT_EQ(ask("Z0,100,2"), "OK");
  EXPECT_EQ(ask("Z2,20000000,4"), "OK");
  EXPECT_EQ(target.points.size(), 2U);
  EXPECT_EQ(ask("z0,100,2"), "OK");
  EXPECT_EQ(ask("z0,100,2"), "OK");
  EXPECT_EQ(target.points.size(), 1U);
  EXPECT_EQ(ask("Z5,0,0"), "");
  EXPECT_EQ(ask("Z0,d4,2"), "OK");
  EXPECT_EQ(ask("z0,d4,4"), "OK") << "as LLDB removes it";
  EXPECT_EQ(target.points.size(), 1U);
  {
    Client other(target);
    other.handle({Arrival::Kind::packet, "Z1,200,2"});
    EXPECT_EQ(target.points.size(), 2U);
  }
  EXPECT_EQ(target.points.size(), 1U);
}

TEST_F(ClientTest, ResumesAndTellsWhyItStands) {
  ask("qSupported:swbreak+;hwbreak+");
  EXPECT_EQ(ask("vCont;r100,120:1"), "(none)");
  EXPECT_EQ(request.kind, Request::Kind::resume);
  EXPECT_EQ(request.resume.kind, Resume::Kind::range);
  EXPECT_EQ(request.resume.range_end, 0x120U);
  client.stopped({StopCause::Kind::watchpoint, StopPoint::read_watchpoint, 0x20000004});
  EXPECT_EQ(last_payload().substr(0, 20), "T05rwatch:20000004;t");
  client.stopped({StopCause::Kind::step});
  EXPECT_EQ(last_payload(), "(none)") << "nobody asked";
  ask("vCont;s:1;c");
  EXPECT_EQ(request.resume.kind, Resume::Kind::step);
  client.stopped({StopCause::Kind::breakpoint, StopPoint::hardware_breakpoint});
  EXPECT_EQ(last_payload().substr(0, 12), "T05hwbreak:;");
  ask("vCont;c");
  EXPECT_EQ(client.handle({Arrival::Kind::interrupt}).kind, Request::Kind::halt);
  client.stopped({StopCause::Kind::interrupted});
  EXPECT_EQ(last_payload().substr(0, 3), "T02");
  ask("c");
  client.exited(3);
  EXPECT_EQ(last_payload(), "W03");
}

TEST_F(ClientTest, MonitorAnswersEveryLine) {
  const auto monitor = [&](const std::string& line) { return ask("qRcmd," + to_hex(line)); };
  for (const char* line :
       {"reset", "reset halt", "reset init", "system_reset", "halt", "stop", "help", "",
        "arm semihosting enable", "rtt setup", "gdb_sync", "an unknown word", "\x01\xff"})
    EXPECT_EQ(monitor(line), "OK") << line;
  EXPECT_EQ(target.resets, 4);
  monitor("reset run");
  EXPECT_EQ(request.kind, Request::Kind::resume);
  monitor("reset halt");
  EXPECT_EQ(request.kind, Request::Kind::halt);
  EXPECT_NE(answer_monitor("unheard of").text.find("not known"), std::string::npos);
}

/// LLDB's gdb-remote extension; a hole has no permissions and ends where the next range begins.
TEST_F(ClientTest, RegionsAndHolesOfTheMemoryMap) {
  EXPECT_EQ(ask("qMemoryRegionInfo:20000000"), "start:20000000;size:10000;permissions:rwx;");
  EXPECT_EQ(ask("qMemoryRegionInfo:2000ffff"), "start:20000000;size:10000;permissions:rwx;");
  EXPECT_EQ(ask("qMemoryRegionInfo:0"), "start:0;size:20000000;");
  EXPECT_EQ(ask("qMemoryRegionInfo:20010000"), "start:20010000;size:10000;");
  EXPECT_EQ(ask("qMemoryRegionInfo:20020fff"), "start:20020000;size:1000;permissions:rwx;");
  EXPECT_EQ(ask("qMemoryRegionInfo:ffffffff"), "start:20021000;size:dffdf000;");
  EXPECT_EQ(ask("qMemoryRegionInfo:"), "E01");
  EXPECT_EQ(ask("qMemoryRegionInfo:100000000"), "E01");
}

TEST_F(ClientTest, StimulusPortsAreEnabledAndDisabled) {
  const auto check = [](const std::string& line, uint32_t ports, bool on) {
    const MonitorAnswer answer = answer_monitor(line);
    EXPECT_EQ(answer.stimulus_ports, ports) << line;
    EXPECT_EQ(answer.stimulus_on, on) << line;
    EXPECT_EQ(answer.text.empty(), ports != 0) << line;
  };
  check("itm port 0 on", 1, true);
  check("itm port 31 1", 1U << 31U, true);
  check("itm port 3 off", 8, false);
  check("itm ports on", 0xFFFFFFFF, true);
  check("itm ports 0", 0xFFFFFFFF, false);
  for (const char* wrong :
       {"itm", "itm port", "itm port 32 on", "itm port x on", "itm port 1 maybe", "itm ports"})
    check(wrong, 0, false);
}

TEST_F(ClientTest, DetachesAndEnds) {
  EXPECT_EQ(ask("D"), "OK");
  EXPECT_EQ(request.kind, Request::Kind::detach);
  ask("k");
  EXPECT_EQ(request.kind, Request::Kind::kill);
  EXPECT_EQ(ask("!"), "OK");
  EXPECT_EQ(ask("vKill;1"), "OK");
  EXPECT_EQ(request.kind, Request::Kind::halt) << "an extended client may run again";
  EXPECT_EQ(ask("vRun;").substr(0, 3), "T05");
  EXPECT_EQ(target.resets, 1);
}

TEST_F(ClientTest, ComparesSectionsByTheirChecksum) {
  target.write_memory(FakeTarget::base, "123456789");
  EXPECT_EQ(ask("qCRC:20000000,9"), "C376e6e7") << "CRC-32/MPEG-2 of the digits";
}

}  // namespace
}  // namespace capsoc::debug::test
