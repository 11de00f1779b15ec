// SPDX-License-Identifier: Apache-2.0
#include "bench/serving/tcp_server.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <map>
#include <mutex>

#include <gtest/gtest.h>

namespace strainwave::bench::tcp_server_test {
namespace {

// Lines: "echo", which is answered; "wait", whose client is given what `Give` says.
class Lines : public RequestProtocol {
 public:
  std::optional<std::size_t> LengthOf(std::string_view received) override {
    const std::size_t end = received.find('\n');
    return end == received.npos ? std::nullopt : std::optional(end + 1);
  }
  Reply Answer(std::string_view request, const Caller& caller) override {
    if (request == "who\n") return {.bytes = caller.address + " to " + caller.own_address, .closes = true};
    if (request == "echo\n") return {.bytes = "echo\n", .closes = true};
    const std::lock_guard lock(mutex_);
    waiting_[caller.id] = true;
    return {.bytes = "hello\n", .waits = true};
  }
  std::vector<Delivery> Deliveries(Time) override {
    const std::lock_guard lock(mutex_);
    std::vector<Delivery> deliveries;
    if (given_.empty()) return deliveries;
    for (const auto& [client, waits] : waiting_) deliveries.push_back({client, given_, closes_});
    if (!endless_) given_.clear();
    return deliveries;
  }
  void Left(ClientId client) override {
    const std::lock_guard lock(mutex_);
    waiting_.erase(client);
  }
  std::string LastWords(Refusal why) override {
    return why == Refusal::kTooLong ? "too long\n" : "too slow\n";
  }

  void Give(TcpServer& server, std::string bytes, bool closes, bool endless = false) {
    {
      const std::lock_guard lock(mutex_);
      given_ = std::move(bytes);
      closes_ = closes;
      endless_ = endless;
    }
    server.Wake();
  }
  // As long as it is held, the server lets nobody in.
  std::unique_lock<std::mutex> Hold() { return std::unique_lock(mutex_); }
  std::size_t waiting() {
    const std::lock_guard lock(mutex_);
    return waiting_.size();
  }

 private:
  std::mutex mutex_;
  std::map<ClientId, bool> waiting_;
  std::string given_;
  bool closes_{};
  bool endless_{};
};

class Client {
 public:
  explicit Client(int port, const char* to = "127.0.0.1", const char* from = "127.0.0.1")
      : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const sockaddr_in here = At(from, 0);
    const sockaddr_in there = At(to, port);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&here), sizeof here), 0);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&there), sizeof there), 0);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  ~Client() { ::close(socket_); }

  void Send(std::string_view text) {
    EXPECT_EQ(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  // As many as asked for, or until the server closes.
  std::string Receive(std::size_t most) {
    std::string got(most, '\0');
    std::size_t size = 0;
    for (ssize_t count = 1; count > 0 && size < most;
         size += static_cast<std::size_t>(std::max<ssize_t>(count, 0))) {
      count = ::recv(socket_, got.data() + size, most - size, 0);
    }
    got.resize(size);
    return got;
  }

 private:
  static sockaddr_in At(const char* text, int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    EXPECT_EQ(::inet_pton(AF_INET, text, &address.sin_addr), 1);
    return address;
  }

  int socket_;
};

class TcpServerTest : public testing::Test {
 protected:
  static constexpr std::size_t kMany = 1 << 24;

  Lines lines_;
  TcpServer server_{"lines",
                    {.address = "127.0.0.1", .connections = 200},
                    lines_,
                    {.longest_request_bytes = 64, .most_unsent_bytes = 1 << 16, .lingers = true}};
};

TEST_F(TcpServerTest, AnswersAtOnceThoughManyWait) {
  std::list<Client> waiting;
  for (int i = 0; i < 100; ++i) {
    waiting.emplace_back(server_.port()).Send("wait\n");
    EXPECT_EQ(waiting.back().Receive(6), "hello\n");
  }
  Client client(server_.port());
  client.Send("echo\n");
  EXPECT_EQ(client.Receive(kMany), "echo\n");
  lines_.Give(server_, "news\n", true);
  for (Client& waited : waiting) EXPECT_EQ(waited.Receive(kMany), "news\n");
}

TEST_F(TcpServerTest, GivesAWaitingClientMoreThanTheLimitOfWhatItHasNotTaken) {
  Client client(server_.port());
  client.Send("wait\n");
  EXPECT_EQ(client.Receive(6), "hello\n");
  lines_.Give(server_, std::string(4 << 20, 'x'), true);
  EXPECT_EQ(client.Receive(kMany).size(), std::size_t{4} << 20);
}

TEST_F(TcpServerTest, ClosesAWaitingClientThatTakesNothing) {
  Client client(server_.port());
  client.Send("wait\n");
  EXPECT_EQ(client.Receive(6), "hello\n");
  lines_.Give(server_, std::string(1 << 20, 'x'), false, true);
  while (lines_.waiting() > 0) ::usleep(1000);  // another thread closes it: nothing to wait on
}

TEST_F(TcpServerTest, NoticesThatAWaitingClientHasLeft) {
  {
    Client client(server_.port());
    client.Send("wait\n");
    EXPECT_EQ(client.Receive(6), "hello\n");
    EXPECT_EQ(lines_.waiting(), 1u);
  }
  while (lines_.waiting() > 0) ::usleep(1000);
}

TEST_F(TcpServerTest, KnowsBothEndsOfAConnection) {
  TcpServer everywhere("lines", {.address = "0.0.0.0"}, lines_);
  Client client(everywhere.port(), "127.0.0.2", "127.0.0.3");
  client.Send("who\n");
  EXPECT_EQ(client.Receive(kMany), "127.0.0.3 to 127.0.0.2");
}

TEST_F(TcpServerTest, LeavesRoomForOthersThanAMachineThatTakesAllItGets) {
  TcpServer everywhere("lines", {.address = "0.0.0.0", .connections = 4, .of_one_network = 2}, lines_);
  Client first(everywhere.port());
  first.Send("wait\n");
  EXPECT_EQ(first.Receive(6), "hello\n");
  std::list<Client> greedy;
  for (int i = 0; i < 8; ++i) {
    greedy.emplace_back(everywhere.port(), "127.0.0.1", "127.0.0.3").Send("wait\n");
    EXPECT_EQ(greedy.back().Receive(6), "hello\n");
  }
  lines_.Give(everywhere, "news\n", true);
  EXPECT_EQ(first.Receive(kMany), "news\n");
  EXPECT_EQ(greedy.front().Receive(kMany), "") << "closed for one of its own";
  EXPECT_EQ(greedy.back().Receive(kMany), "news\n");
}

TEST_F(TcpServerTest, LeavesHalfOfThePlacesToThoseWhoAreServed) {
  TcpServer small("lines", {.address = "127.0.0.1", .connections = 4}, lines_);
  std::list<Client> served;
  for (int i = 0; i < 3; ++i) {
    served.emplace_back(small.port()).Send("wait\n");
    EXPECT_EQ(served.back().Receive(6), "hello\n");
  }
  std::list<Client> strangers;
  for (int i = 0; i < 20; ++i) strangers.emplace_back(small.port());
  EXPECT_EQ(strangers.front().Receive(kMany), "") << "closed for one of its own kind";
  EXPECT_EQ(served.front().Receive(kMany), "") << "the one of them that is beyond the half";
  strangers.back().Send("echo\n");
  EXPECT_EQ(strangers.back().Receive(kMany), "echo\n");
  lines_.Give(small, "news\n", true);
  EXPECT_EQ(std::next(served.begin())->Receive(kMany), "news\n");
  EXPECT_EQ(served.back().Receive(kMany), "news\n");
}

TEST_F(TcpServerTest, LetsInANewClientThoughAllOthersAreServed) {
  TcpServer small("lines", {.address = "127.0.0.1", .connections = 2}, lines_);
  std::list<Client> served;
  for (int i = 0; i < 3; ++i) {
    served.emplace_back(small.port()).Send("wait\n");
    EXPECT_EQ(served.back().Receive(6), "hello\n");
  }
  EXPECT_EQ(served.front().Receive(kMany), "");
}

TEST_F(TcpServerTest, AnswersARequestThatIsThereBeforeAnotherTakesItsPlace) {
  TcpServer everywhere("lines", {.address = "0.0.0.0", .connections = 8, .of_one_network = 1}, lines_);
  std::list<Client> clients;
  {
    const auto held = lines_.Hold();
    for (int i = 0; i < 8; ++i) clients.emplace_back(everywhere.port()).Send("echo\n");
  }
  for (Client& client : clients) EXPECT_EQ(client.Receive(kMany), "echo\n");
}

TEST_F(TcpServerTest, HasLastWordsForWhoSendsTooMuchOrTooSlowly) {
  Client talkative(server_.port());
  talkative.Send(std::string(10000, 'x'));
  EXPECT_EQ(talkative.Receive(kMany), "too long\n");
  Client slow(server_.port());
  slow.Send("ec");
  EXPECT_EQ(slow.Receive(kMany), "too slow\n");
}

}  // namespace
}  // namespace strainwave::bench::tcp_server_test
