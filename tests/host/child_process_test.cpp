#include "host/child_process.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "host/end_signals.h"

namespace capsoc::host {
namespace {

TEST(Apart, SaysWhatTheWorkSaid) {
  const Apart apart = perform_apart([] { return std::string(100'000, 'x') + "y"; });
  EXPECT_EQ(apart.end, Apart::End::finished);
  EXPECT_EQ(apart.text.size(), 100'001U);
  EXPECT_EQ(apart.text.back(), 'y');
}

TEST(Apart, ACrashIsNamed) {
  const Apart apart = perform_apart([]() -> std::string { _exit(3); });
  EXPECT_EQ(apart.end, Apart::End::crashed);
}

/// A signal is noted while nothing waits for the work yet: as here by a thread, it interrupts no
/// wait.
TEST(Apart, ASignalThatInterruptsNoWaitEndsTheWork) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);  // where it is missed, this ends the wait
    std::thread late([] {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      note_signal(SIGTERM);
    });
    const Apart apart = perform_apart([]() -> std::string {
      pause();
      return "";
    });
    late.join();
    _exit(apart.end == Apart::End::crashed ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace capsoc::host
