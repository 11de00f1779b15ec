// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_post.h"

#include <future>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::bench::notice_post_test {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPatience{60'000};  // against hanging: no measure of anything

// Takes nothing before it is told to.
class HungSender : public NoticeSender {
 public:
  explicit HungSender(std::shared_future<void> released) : released_(std::move(released)) {}
  std::string Send(const Notice&) override {
    released_.wait();
    return "";
  }

 private:
  std::shared_future<void> released_;
};

class ReadySender : public NoticeSender {
 public:
  std::string Send(const Notice& notice) override {
    if (notice.id == "thrown") throw std::runtime_error("no room");
    return notice.id == "refused" ? "not this one" : "";
  }
};

Notice Made(const std::string& id) {
  Notice notice;
  notice.id = id;
  return notice;
}

class Post : public testing::Test {
 protected:
  Post() : post_(Senders()) {}
  ~Post() override { release_.set_value(); }

  std::vector<NamedSender> Senders() {
    std::vector<NamedSender> senders;
    senders.push_back({"hung", "", std::make_unique<HungSender>(release_.get_future().share())});
    senders.push_back({"ready", "", std::make_unique<ReadySender>()});
    return senders;
  }
  std::string OutcomeOf(const std::string& id) {
    post_.Send("ready", Made(id));
    const auto outcomes = post_.Take(kPatience);
    if (outcomes.size() != 1) return "nothing";
    return outcomes[0].channel + " " + outcomes[0].id + " " + outcomes[0].trouble;
  }

  std::promise<void> release_;
  NoticePost post_;
};

TEST_F(Post, SendsOverAChannelWhileAnotherHangs) {
  post_.Send("hung", Made("a"));
  EXPECT_EQ(OutcomeOf("a"), "ready a ");
  EXPECT_EQ(OutcomeOf("b"), "ready b ");
  EXPECT_FALSE(post_.IsFree("hung"));
  EXPECT_TRUE(post_.IsFree("ready"));
  EXPECT_FALSE(post_.IsFree());
}

TEST_F(Post, TellsWhyANoticeWasNotTaken) {
  EXPECT_EQ(OutcomeOf("refused"), "ready refused not this one");
  EXPECT_EQ(OutcomeOf("thrown"), "ready thrown no room");
}

TEST_F(Post, HasAChannelThatIsFreeOnlyOnceItsOutcomeWasTaken) {
  EXPECT_EQ(post_.channels(), (std::vector<std::string>{"hung", "ready"}));
  post_.Send("ready", Made("a"));
  EXPECT_FALSE(post_.IsFree("ready"));
  post_.Send("ready", Made("a"));  // in vain: it is not free
  EXPECT_EQ(post_.Take(kPatience).size(), 1U);
  EXPECT_TRUE(post_.IsFree("ready"));
  EXPECT_FALSE(post_.IsFree("no such channel"));
}

}  // namespace
}  // namespace strainwave::bench::notice_post_test
