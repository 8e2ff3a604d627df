// The list of observers: the order of its calls, and what it gathers from them.
#include "observers/run_observer.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

namespace capsoc::run {
namespace {

/// Notes its calls in a text that it shares with the others.
class Noted final : public RunObserver {
 public:
  Noted(std::string name, std::string& calls) : name_(std::move(name)), calls_(calls) {}
  ~Noted() override { note("gone"); }

  std::optional<Error> open() override {
    note("open");
    if (name_ == "wrong") return Error{"a wrong setting"};
    return std::nullopt;
  }
  void close(RunResult& result) override {
    note("close");
    result.lost.push_back(name_ + " was lost");
  }
  void finish(RunResult& result) override {
    note("finish");
    if (result.code == exit_code::pass) result.reason += name_;
  }
  std::string crash() const override { return name_ == "b" || name_ == "c" ? name_ : ""; }
  std::optional<Finding> finding() const override {
    if (name_ == "b") return std::nullopt;
    return Finding{name_, "    text\n"};
  }

 private:
  void note(const char* call) { calls_ += name_ + " " + call + ", "; }

  std::string name_;
  std::string& calls_;
};

TEST(RunObserver, OrderIsThatOfOpening) {
  std::string calls;
  Observers all;
  for (const char* name : {"a", "b", "c"})
    ASSERT_FALSE(all.add(std::make_unique<Noted>(name, calls)));
  RunResult result;
  all.close(result);
  all.finish(result);
  EXPECT_EQ(calls,
            "a open, b open, c open, a close, b close, c close, a finish, b finish, c finish, ");
  EXPECT_EQ(result.lost, (std::vector<std::string>{"a was lost", "b was lost", "c was lost"}));
  EXPECT_EQ(result.reason, "abc");
}

TEST(RunObserver, WrongSettingIsNotObserved) {
  std::string calls;
  Observers all;
  const auto error = all.add(std::make_unique<Noted>("wrong", calls));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->text, "a wrong setting");
  RunResult result;
  all.close(result);
  EXPECT_EQ(calls, "wrong open, wrong gone, ");
}

TEST(RunObserver, FirstCrashAndAllFindings) {
  std::string calls;
  Observers all;
  EXPECT_EQ(all.crash(), "");
  for (const char* name : {"a", "b", "c"})
    ASSERT_FALSE(all.add(std::make_unique<Noted>(name, calls)));
  EXPECT_EQ(all.crash(), "b");
  const Findings findings = all.findings();
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].heading, "a");
  EXPECT_EQ(findings[1].heading, "c");
}

}  // namespace
}  // namespace capsoc::run
