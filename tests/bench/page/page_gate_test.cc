// SPDX-License-Identifier: Apache-2.0
#include "bench/page/page_gate.h"

#include <gtest/gtest.h>

#include "bench/page/viewers.h"
#include "bench/serving/addresses.h"

namespace strainwave::bench::page_gate_test {
namespace {

constexpr const char* kHere = "127.0.0.1";
constexpr const char* kBench = "192.0.2.7";

TEST(PageGate, IsOpenToThisMachineAlone) {
  for (const char* address : {"127.0.0.1", "127.9.9.9", "::1", "0:0:0:0:0:0:0:1", "::ffff:127.0.0.1"}) {
    EXPECT_TRUE(PageGate(address, {}).is_open()) << address;
  }
  for (const char* address : {"0.0.0.0", "::", "192.0.2.7", "128.0.0.1", "2001:db8::1", "localhost", ""}) {
    EXPECT_FALSE(PageGate(address, {}).is_open()) << address;
  }
}

TEST(PageGate, GuardsAllButTheFilesAndTheLogin) {
  const PageGate gate(kBench, {});
  for (const char* path : {"/api/v1/state", "/api/v1/events", kActionsPath, "/api/", "/api/v1/login/",
                           "/api/v1/loginx", "/api/v2/anything"}) {
    EXPECT_TRUE(gate.IsGuarded(path)) << path;
    EXPECT_FALSE(PageGate(kHere, {}).IsGuarded(path)) << path;
  }
  for (const char* path : {"/", "/page.mjs", kLoginPath, kLogoutPath}) {
    EXPECT_FALSE(gate.IsGuarded(path)) << path;
  }
}

TEST(PageGate, OnTheLoopbackIsAskedForByItsName) {
  const PageGate gate(kHere, {});
  for (const char* host : {"localhost", "LOCALHOST:8080", "127.0.0.1:9", "[::1]:80", "[::1]"}) {
    EXPECT_EQ(gate.WrongHost(host, kHere), std::nullopt) << host;
  }
  for (const char* host : {"", "localhost.evil.example", "evil.example:8080", "127.0.0.1.evil.example",
                           "10.0.0.1", "localhost:80x", "[::1", "[localhost]", "localhost@evil.example"}) {
    EXPECT_EQ(gate.WrongHost(host, kHere),
              "the page is not served under this name (expected localhost or 127.0.0.1)")
        << host;
  }
}

TEST(PageGate, ForOthersIsAskedForByItsAddressOrANameThatIsAllowed) {
  const PageGate gate("0.0.0.0", {"Bench.example"});
  for (const char* host : {"192.0.2.7", "192.0.2.7:8443", "bench.example", "BENCH.EXAMPLE:8443"}) {
    EXPECT_EQ(gate.WrongHost(host, kBench), std::nullopt) << host;
  }
  EXPECT_EQ(gate.WrongHost("[2001:DB8:0::1]:8443", "2001:db8::1"), std::nullopt);
  for (const char* host : {"192.0.2.8", "bench", "bench.example.evil.example", "evil.example", "0.0.0.0"}) {
    EXPECT_EQ(gate.WrongHost(host, kBench),
              "the page is not served under this name (expected this machine's address, or a name of it that "
              "--host allows)")
        << host;
  }
}

TEST(PageUrls, SayWhereThePageIs) {
  EXPECT_EQ(PageUrl(false, "127.0.0.1", {}, 8080), "http://127.0.0.1:8080/");
  EXPECT_EQ(PageUrl(true, "192.0.2.7", {"bench.example", "b"}, 443), "https://bench.example:443/");
  EXPECT_EQ(PageUrl(true, "2001:db8::1", {}, 8443), "https://[2001:db8::1]:8443/");
  EXPECT_EQ(PageUrl(true, "::", {}, 8443), "https://127.0.0.1:8443/");
}

TEST(HostNames, AreLettersDigitsHyphensAndDots) {
  for (const char* name : {"bench", "bench-2.example", "B", "192.0.2.7"})
    EXPECT_TRUE(IsHostName(name)) << name;
  for (const std::string& name :
       {std::string(), std::string("a b"), std::string("bench:80"), std::string("-a"), std::string(".a"),
        std::string("a/b"), std::string(254, 'a')}) {
    EXPECT_FALSE(IsHostName(name)) << name;
  }
}

TEST(Addresses, HaveOneSpellingAndCountByMachine) {
  EXPECT_EQ(CanonicalAddress("2001:DB8:0:0::0001"), "2001:db8::1");
  EXPECT_EQ(CanonicalAddress("::ffff:192.0.2.7"), "192.0.2.7");
  for (const char* none : {"", "localhost", "192.0.2", "1.2.3.4:80", "[::1]"}) {
    EXPECT_EQ(CanonicalAddress(none), "") << none;
  }
  EXPECT_EQ(NetworkOf("192.0.2.7"), "192.0.2.7");
  EXPECT_EQ(NetworkOf("2001:db8:1:2:3:4:5:6"), NetworkOf("2001:db8:1:2:ffff::9"));
  EXPECT_NE(NetworkOf("2001:db8:1:2::1"), NetworkOf("2001:db8:1:3::1"));
  EXPECT_TRUE(IsEveryAddress("0.0.0.0"));
  EXPECT_TRUE(IsEveryAddress("0::0"));
  EXPECT_FALSE(IsEveryAddress("127.0.0.1"));
}

TEST(PageViewers, AreEndedWithTheirSession) {
  Viewers viewers;
  viewers.Add(1, 0, "holds");
  viewers.Add(2, 0, "over");
  const auto ended = viewers.EndWhere([](const std::string& session) { return session == "over"; });
  ASSERT_EQ(ended.size(), 1U);
  EXPECT_EQ(ended[0].client, 2U);
  EXPECT_TRUE(ended[0].closes);
  EXPECT_EQ(
      ended[0].bytes,
      "event: over\ndata: {\"error\":\"from other machines the page is for who is logged in, and nobody "
      "is, or the login is over (expected: log in)\",\"why\":\"login\"}\n\n");
  ASSERT_EQ(viewers.Alive(5).size(), 1U);
  EXPECT_EQ(viewers.Alive(5)[0].client, 1U);
  EXPECT_EQ(viewers.Alive(5)[0].bytes, "event: alive\ndata: {\"now_ms\":5}\n\n");
}

TEST(PageViewers, GetEachLineOfTheJournalOnce) {
  Viewers viewers;
  viewers.Add(1, 4, "");
  WatchedCampaign newest;
  newest.events = {{1.0, "", 1, "", "info", "a", "four", 4}, {2.0, "", 1, "", "info", "b", "five", 5}};
  newest.snapshot.last_event = 5;
  const auto first = viewers.News(newest, {});
  ASSERT_EQ(first.size(), 1U);
  EXPECT_TRUE(first[0].bytes.starts_with("id: 5\nevent: journal\n")) << first[0].bytes;
  EXPECT_NE(first[0].bytes.find("event: state\n"), std::string::npos);
  EXPECT_TRUE(viewers.News(newest, {})[0].bytes.starts_with("event: state\n"));
  viewers.Remove(1);
  EXPECT_TRUE(viewers.News(newest, {}).empty());
}

}  // namespace
}  // namespace strainwave::bench::page_gate_test
