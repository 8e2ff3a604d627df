// The arithmetic of the floating-point extension against the host's IEEE 754, in every rounding
// mode. Unicorn judges what IEEE 754 leaves to the architecture (fpu_test.cpp).
#include "armv7m/isa/single_precision.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>

namespace capsoc::armv7m::test {
namespace {

constexpr int host_modes[] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
constexpr uint32_t least_normal = 0x00800000;

float number(uint32_t bits) {
  float value = 0;
  std::memcpy(&value, &bits, 4);
  return value;
}
uint32_t bits_of(float value) {
  uint32_t bits = 0;
  std::memcpy(&bits, &value, 4);
  return bits;
}
bool is_nan(uint32_t bits) {
  return (bits & 0x7FFFFFFF) > 0x7F800000;
}
bool is_signaling(uint32_t bits) {
  return is_nan(bits) && (bits & 0x00400000) == 0;
}

/// Borders of every kind, then numbers near each other, then any bits.
uint32_t some_number(std::mt19937& random) {
  constexpr uint32_t borders[] = {0,          1,          0x007FFFFF, 0x00800000, 0x00800001,
                                  0x3F7FFFFF, 0x3F800000, 0x3F800001, 0x40000000, 0x34000000,
                                  0x33800000, 0x4B000000, 0x4B7FFFFF, 0x4F000000, 0x7F7FFFFF,
                                  0x7F800000, 0x7F800001, 0x7FC00000, 0x7FFFFFFF, 0x20000000};
  const uint32_t any = random();
  switch (random() % 4) {
    case 0:
      return borders[any % std::size(borders)] | (any & 0x80000000);
    case 1:
      return (any & 0x81FFFFFF) + 0x3E000000;
    case 2:
      return (any & 0x807FFFFF) + ((any >> 23 & 3) << 23);
    default:
      return any;
  }
}

/// The flags of the host in FPSCR's order.
uint32_t host_flags() {
  const int raised = std::fetestexcept(FE_ALL_EXCEPT);
  return ((raised & FE_INVALID) != 0 ? Fpscr::invalid : 0) |
         ((raised & FE_DIVBYZERO) != 0 ? Fpscr::divide_by_zero : 0) |
         ((raised & FE_OVERFLOW) != 0 ? Fpscr::overflow : 0) |
         ((raised & FE_UNDERFLOW) != 0 ? Fpscr::underflow : 0) |
         ((raised & FE_INEXACT) != 0 ? Fpscr::inexact : 0);
}

class SinglePrecision : public testing::TestWithParam<unsigned> {
 protected:
  static constexpr unsigned count = 400000;
  std::mt19937 random{GetParam() + 1};
  unsigned tiny = 0, nans = 0, inexact = 0;

  uint32_t fpscr() const { return GetParam() << 22; }
  void TearDown() override { std::fesetround(FE_TONEAREST); }

  /// `mine`: uint32_t (Fpscr&); `theirs`: float ().
  template <typename Mine, typename Theirs>
  void compare(const Mine& mine, const Theirs& theirs) {
    Fpscr status(fpscr());
    const uint32_t result = mine(status);
    std::fesetround(host_modes[GetParam()]);
    std::feclearexcept(FE_ALL_EXCEPT);
    volatile float expected = theirs();
    uint32_t flags = host_flags();
    std::fesetround(FE_TONEAREST);
    const uint32_t expected_bits = bits_of(expected);
    uint32_t raised = status.bits() & Fpscr::exceptions;
    if ((result & 0x7FFFFFFF) == least_normal && (raised & Fpscr::inexact) != 0) {
      // Hosts may look for tininess after rounding.
      flags &= ~Fpscr::underflow;
      raised &= ~Fpscr::underflow;
    }
    if (is_nan(expected_bits)) {
      ASSERT_TRUE(is_nan(result)) << std::hex << result;
      ++nans;
    } else {
      ASSERT_EQ(result, expected_bits);
    }
    ASSERT_EQ(raised, flags) << std::hex << result;
    if ((raised & Fpscr::underflow) != 0) ++tiny;
    if ((raised & Fpscr::inexact) != 0) ++inexact;
  }
  /// Two operands.
  void compare_all(uint32_t (*mine)(uint32_t, uint32_t, Fpscr&), float (*theirs)(float, float)) {
    for (unsigned i = 0; i < count; ++i) {
      const uint32_t x = some_number(random), y = some_number(random);
      volatile float a = number(x), b = number(y);
      ASSERT_NO_FATAL_FAILURE(
          compare([&](Fpscr& status) { return mine(x, y, status); }, [&] { return theirs(a, b); }))
          << std::hex << x << " " << y;
    }
    expect_all_kinds();
  }
  void expect_all_kinds() const {
    EXPECT_GT(nans, count / 100);
    EXPECT_GT(inexact, count / 10);
  }
};
INSTANTIATE_TEST_SUITE_P(Rounding, SinglePrecision, testing::Range(0u, 4u));

TEST_P(SinglePrecision, AddsAsTheHost) {
  compare_all(single::add, [](float a, float b) { return a + b; });
  EXPECT_EQ(tiny, 0u) << "a tiny sum is exact";
}
TEST_P(SinglePrecision, SubtractsAsTheHost) {
  compare_all(single::subtract, [](float a, float b) { return a - b; });
  EXPECT_EQ(tiny, 0u) << "a tiny difference is exact";
}
TEST_P(SinglePrecision, MultipliesAsTheHost) {
  compare_all(single::multiply, [](float a, float b) { return a * b; });
  EXPECT_GT(tiny, count / 1000);
}
TEST_P(SinglePrecision, DividesAsTheHost) {
  compare_all(single::divide, [](float a, float b) { return a / b; });
  EXPECT_GT(tiny, count / 1000);
}

TEST_P(SinglePrecision, MultipliesAndAddsWithOneRounding) {
  for (unsigned i = 0; i < count; ++i) {
    const uint32_t x = some_number(random), y = some_number(random);
    // A sum that nearly cancels is where one rounding and two differ.
    Fpscr any;
    const uint32_t z =
        random() % 2 == 0 ? some_number(random) : single::negate(single::multiply(x, y, any));
    // IEEE 754 leaves open whether infinity times zero is invalid if a quiet NaN is added.
    if (is_nan(z)) continue;
    volatile float a = number(x), b = number(y), c = number(z);
    ASSERT_NO_FATAL_FAILURE(compare([&](Fpscr& s) { return single::multiply_add(z, x, y, s); },
                                    [&] { return std::fma(float{a}, float{b}, float{c}); }))
        << std::hex << x << " " << y << " " << z;
  }
  expect_all_kinds();
}

TEST_P(SinglePrecision, TakesTheSquareRootAsTheHost) {
  for (unsigned i = 0; i < count; ++i) {
    const uint32_t x = some_number(random);
    volatile float a = number(x);
    ASSERT_NO_FATAL_FAILURE(compare([&](Fpscr& s) { return single::square_root(x, s); },
                                    [&] { return std::sqrt(float{a}); }))
        << std::hex << x;
  }
  EXPECT_GT(inexact, count / 10);
}

// Exact in double precision, then rounded once.
TEST_P(SinglePrecision, ConvertsFixedPointNumbers) {
  for (unsigned i = 0; i < count; ++i) {
    single::Fixed format;
    format.width = random() % 2 == 0 ? 16 : 32;
    format.fraction_bits = random() % (format.width + 1);
    format.is_unsigned = random() % 2 == 0;
    const uint32_t bits = random() >> random() % 32;
    const double integer =
        format.width == 16
            ? (format.is_unsigned ? static_cast<uint16_t>(bits) : static_cast<int16_t>(bits))
            : (format.is_unsigned ? double{static_cast<double>(bits)}
                                  : static_cast<double>(static_cast<int32_t>(bits)));
    volatile double exact = std::ldexp(integer, -static_cast<int>(format.fraction_bits));
    ASSERT_NO_FATAL_FAILURE(
        compare([&](Fpscr& s) { return single::from_fixed(bits, format, false, s); },
                [&] { return static_cast<float>(exact); }))
        << std::hex << bits;
  }
}

TEST_P(SinglePrecision, ConvertsToFixedPointNumbers) {
  unsigned saturated = 0;
  for (unsigned i = 0; i < count; ++i) {
    single::Fixed format;
    format.width = random() % 2 == 0 ? 16 : 32;
    format.fraction_bits = random() % (format.width + 1);
    format.is_unsigned = random() % 2 == 0;
    const bool to_zero = random() % 2 == 0;
    uint32_t x = some_number(random);
    if (random() % 2 == 0) x = (x & 0x87FFFFFF) + 0x3A000000;  // of a size that fits
    Fpscr status(fpscr());
    const uint32_t result = single::to_fixed(x, format, to_zero, status);
    const double exact = std::ldexp(double{number(x)}, static_cast<int>(format.fraction_bits));
    std::fesetround(to_zero ? FE_TOWARDZERO : host_modes[GetParam()]);
    volatile double unrounded = exact, rounded_there = 0;
    rounded_there = std::nearbyint(double{unrounded});
    std::fesetround(FE_TONEAREST);
    const double rounded = rounded_there;
    const double most = std::ldexp(1, static_cast<int>(format.width) - !format.is_unsigned) - 1;
    const double least = format.is_unsigned ? 0 : -most - 1;
    double expected = rounded;
    uint32_t flags = rounded != exact ? Fpscr::inexact : 0;
    if (is_nan(x) || rounded > most || rounded < least) {
      flags = Fpscr::invalid;
      expected = is_nan(x) ? 0 : rounded > most ? most : least;
      ++saturated;
    }
    ASSERT_EQ(result, static_cast<uint32_t>(static_cast<int64_t>(expected))) << std::hex << x;
    ASSERT_EQ(status.bits() & Fpscr::exceptions, flags) << std::hex << x;
  }
  EXPECT_GT(saturated, count / 100);
  EXPECT_LT(saturated, count * 3 / 4);
}

TEST_P(SinglePrecision, ComparesAsTheHost) {
  unsigned equal = 0;
  for (unsigned i = 0; i < count; ++i) {
    const uint32_t x = some_number(random);
    const uint32_t y = random() % 4 == 0 ? x : some_number(random);
    const float a = number(x), b = number(y);
    const bool signals = random() % 2 == 0;
    Fpscr status(fpscr());
    const uint32_t nzcv = single::compare(x, y, signals, status);
    const bool unordered = is_nan(x) || is_nan(y);
    const uint32_t expected = unordered ? 3u : a < b ? 8u : a == b ? 6u : 2u;
    ASSERT_EQ(nzcv, expected << 28) << std::hex << x << " " << y;
    const bool invalid = unordered && (signals || is_signaling(x) || is_signaling(y));
    ASSERT_EQ(status.bits() & Fpscr::exceptions, invalid ? Fpscr::invalid : 0u);
    equal += expected == 6 ? 1 : 0;
  }
  EXPECT_GT(equal, count / 10);
}

// Each half-precision number is a single-precision one, and the way back is exact.
TEST_P(SinglePrecision, KeepsEachHalfPrecisionNumber) {
  for (const uint32_t alternative : {0u, 1u << 26}) {
    for (uint32_t half = 0; half < 0x10000; ++half) {
      Fpscr status(fpscr() | alternative);
      const uint32_t x = single::from_half(half, status);
      const uint32_t exponent = half >> 10 & 0x1F, fraction = half & 0x3FF;
      if (exponent == 31 && alternative == 0) {
        ASSERT_EQ(is_nan(x), fraction != 0);
        ASSERT_EQ(status.bits() & Fpscr::exceptions,
                  fraction != 0 && fraction < 0x200 ? Fpscr::invalid : 0u);
        if (fraction == 0) {
          ASSERT_EQ(x, (half & 0x8000) << 16 | 0x7F800000);
        }
        continue;
      }
      const double value = exponent == 0
                               ? std::ldexp(fraction, -24)
                               : std::ldexp(1024 + fraction, static_cast<int>(exponent) - 25);
      ASSERT_EQ(double{number(x)}, (half & 0x8000) != 0 ? -value : value) << half;
      ASSERT_EQ(single::to_half(x, status), half);
      ASSERT_EQ(status.bits() & Fpscr::exceptions, 0u) << half;
    }
  }
}

// A2.5.5, A2.5.6 and FPRound: what IEEE 754 does not have.
TEST(SinglePrecisionModes, FlushesToZero) {
  Fpscr status(1u << 24);
  EXPECT_EQ(single::add(0x007FFFFF, 0x80000000, status), 0u) << "operand";
  EXPECT_EQ(status.bits() & Fpscr::exceptions, Fpscr::input_denormal);
  status = Fpscr(1u << 24);
  EXPECT_EQ(single::multiply(0x80800000, 0x3F000000, status), 0x80000000) << "result";
  EXPECT_EQ(status.bits() & Fpscr::exceptions, Fpscr::underflow) << "not inexact";
  status = Fpscr(1u << 24);
  EXPECT_EQ(single::to_half(0x33800000, status), 1u) << "not in half precision";
  EXPECT_EQ(status.bits() & Fpscr::exceptions, 0u);
}
TEST(SinglePrecisionModes, ATinyResultThatIsExactIsNoUnderflow) {
  Fpscr status;
  EXPECT_EQ(single::multiply(0x00800000, 0x3F000000, status), 0x00400000u);
  EXPECT_EQ(status.bits() & Fpscr::exceptions, 0u);
  // Rounds up to the least normal number: tiny before rounding.
  EXPECT_EQ(single::multiply(0x3F7FFFFF, 0x00800000, status), 0x00800000u);
  EXPECT_EQ(status.bits() & Fpscr::exceptions, Fpscr::underflow | Fpscr::inexact);
}
TEST(SinglePrecisionModes, NamesTheNanThatItPassesOn) {
  constexpr uint32_t quiet = 0x7FC00001, quiet_too = 0xFFC00002, signaling = 0x7F800003;
  Fpscr status;
  EXPECT_EQ(single::add(quiet, quiet_too, status), quiet);
  EXPECT_EQ(status.bits() & Fpscr::exceptions, 0u);
  EXPECT_EQ(single::add(quiet, signaling, status), 0x7FC00003u);
  EXPECT_EQ(status.bits() & Fpscr::exceptions, Fpscr::invalid);
  EXPECT_EQ(single::subtract(0x3F800000, quiet_too, status), quiet_too) << "its sign stays";
  EXPECT_EQ(single::multiply_add(quiet_too, quiet, 0x3F800000, status), quiet_too);
  Fpscr defaults(1u << 25);
  EXPECT_EQ(single::add(quiet_too, 0, defaults), 0x7FC00000u);
  Fpscr added;
  EXPECT_EQ(single::multiply_add(quiet_too, 0, 0x7F800000, added), 0x7FC00000u);
  EXPECT_EQ(added.bits() & Fpscr::exceptions, Fpscr::invalid) << "infinity times zero";
}
TEST(SinglePrecisionModes, TheAlternativeHalfPrecisionHasNoInfinity) {
  Fpscr status(1u << 26);
  EXPECT_EQ(single::to_half(0xFF800000, status), 0xFFFFu);
  EXPECT_EQ(status.bits() & Fpscr::exceptions, Fpscr::invalid);
  status = Fpscr(1u << 26);
  EXPECT_EQ(single::to_half(0x7FC00000, status), 0u);
  EXPECT_EQ(status.bits() & Fpscr::exceptions, Fpscr::invalid);
  status = Fpscr(1u << 26);
  EXPECT_EQ(single::to_half(0x48000000, status), 0x7FFFu) << "2^17";
  EXPECT_EQ(status.bits() & Fpscr::exceptions, Fpscr::invalid) << "not inexact";
  status = Fpscr(1u << 26);
  EXPECT_EQ(single::to_half(0x47FFE000, status), 0x7FFFu) << "131008, the largest";
  EXPECT_EQ(status.bits() & Fpscr::exceptions, 0u);
}

TEST(SinglePrecisionModes, ImmediatesAreSixteenthsOfPowersOfTwo) {
  EXPECT_EQ(single::expand_immediate(0x70), 0x3F800000u);
  EXPECT_EQ(single::expand_immediate(0x00), 0x40000000u);
  EXPECT_EQ(single::expand_immediate(0xFF), bits_of(-1.9375f));
  EXPECT_EQ(single::expand_immediate(0x40), bits_of(0.125f));
  EXPECT_EQ(single::expand_immediate(0x3F), bits_of(31.f));
}

}  // namespace
}  // namespace capsoc::armv7m::test
