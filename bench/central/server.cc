// SPDX-License-Identifier: Apache-2.0
#include "bench/central/server.h"

#include <libpq-fe.h>
#include <poll.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <initializer_list>
#include <regex>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace strainwave::bench {
namespace {

constexpr std::int64_t kLook_ms = 100;  // how often whoever waits is asked whether to end

std::int64_t SteadyMilliseconds() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

// The first line of what libpq says.
std::string FirstLine(std::string_view words) {
  std::string line(words.substr(0, words.find('\n')));
  while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.pop_back();
  return line;
}

// While connecting there is no result that has an SQLSTATE; said at length, the message has one:
// "... FATAL:  28P01: password authentication failed".
struct ConnectFailure {
  std::string sqlstate;
  std::string words;
};

ConnectFailure ReadConnectFailure(const std::string& said) {
  static const std::regex kWithState(R"(^(.*?)[^ :]+:  ([0-9A-Z]{5}): (.*)$)");
  const std::string line = FirstLine(said);
  std::smatch match;
  if (!std::regex_match(line, match, kWithState)) return {"", line};
  return {match[2], match[3]};
}

struct FreeOptions {
  void operator()(PQconninfoOption* options) const { PQconninfoFree(options); }
};
using Options = std::unique_ptr<PQconninfoOption, FreeOptions>;

Options ParsedConninfo(const std::string& conninfo) {
  char* trouble = nullptr;
  Options options(PQconninfoParse(conninfo.c_str(), &trouble));
  if (!options) {
    const std::string words = trouble == nullptr ? "no memory" : FirstLine(trouble);
    PQfreemem(trouble);
    Refuse("--server", words, "as host=HOST dbname=NAME user=ROLE, or service=NAME");
  }
  return options;
}

}  // namespace

ServerError::ServerError(Kind kind, std::string sqlstate, const std::string& sentence)
    : BenchError(kind == Kind::kAway      ? ExitCode::kMachineFailed
                 : kind == Kind::kRefused ? ExitCode::kWrongInput
                                          : ExitCode::kInterrupted,
                 sentence),
      kind_(kind),
      sqlstate_(std::move(sqlstate)) {}

ServerError::Kind KindOfSqlstate(std::string_view sqlstate) {
  // Connections, resources (a full disk is 53100), the operator's doing (57P01: going down), what the
  // server's machine refuses, what lost a race, what a standby does not do, and what went wrong within.
  for (const std::string_view later : {"08", "53", "57", "58", "40", "55", "25006", "XX"}) {
    if (sqlstate.starts_with(later)) return ServerError::Kind::kAway;
  }
  return sqlstate.empty() ? ServerError::Kind::kAway : ServerError::Kind::kRefused;
}

void ServerRows::Clear::operator()(pg_result* result) const { PQclear(result); }
ServerRows::ServerRows(pg_result* result) : result_(result) {}
int ServerRows::count() const { return PQntuples(result_.get()); }
std::int64_t ServerRows::affected() const { return std::strtoll(PQcmdTuples(result_.get()), nullptr, 10); }
bool ServerRows::IsNull(int row, int column) const { return PQgetisnull(result_.get(), row, column) != 0; }
std::string_view ServerRows::View(int row, int column) const {
  return {PQgetvalue(result_.get(), row, column),
          static_cast<std::size_t>(PQgetlength(result_.get(), row, column))};
}
std::int64_t ServerRows::Integer(int row, int column) const {
  return std::strtoll(PQgetvalue(result_.get(), row, column), nullptr, 10);
}
double ServerRows::Real(int row, int column) const {
  return std::strtod(PQgetvalue(result_.get(), row, column), nullptr);
}

void CheckConninfo(const std::string& conninfo) {
  const Options options = ParsedConninfo(conninfo);
  for (const PQconninfoOption* option = options.get(); option->keyword != nullptr; ++option) {
    const std::string_view keyword = option->keyword;
    if ((keyword == "password" || keyword == "sslpassword") && option->val != nullptr) {
      Refuse("--server", fmt::format("has a {}, which everybody on this machine can read there", keyword),
             "it in ~/.pgpass, or in the file that passfile=FILE or PGPASSFILE names");
    }
  }
}

std::string ShownConninfo(const std::string& conninfo) {
  const Options options = ParsedConninfo(conninfo);
  std::string shown;
  for (const PQconninfoOption* option = options.get(); option->keyword != nullptr; ++option) {
    if (option->val == nullptr) continue;
    const std::string_view keyword = option->keyword;
    for (const std::string_view name : {"service", "user", "dbname", "host", "hostaddr", "port"}) {
      if (keyword == name) shown += fmt::format("{}{}={}", shown.empty() ? "" : " ", keyword, option->val);
    }
  }
  return shown.empty() ? "the server of the environment" : shown;
}

void Server::Finish::operator()(pg_conn* connection) const { PQfinish(connection); }

Server::Server(const std::string& conninfo, std::function<bool()> is_to_end, const ServerPatience& patience)
    : shown_(ShownConninfo(conninfo)), is_to_end_(std::move(is_to_end)), patience_(patience) {
  // What comes later wins: the user's words over the first three. tcp_user_timeout bounds connecting, too, so
  // that libpq goes on to the next of several hosts; its own connect_timeout holds for PQconnectdb alone.
  const char* const keywords[] = {"fallback_application_name", "tcp_user_timeout",
                                  "keepalives_idle",           "dbname",
                                  "client_encoding",           nullptr};
  const char* const values[] = {"strainwave", "10000", "30", conninfo.c_str(), "UTF8", nullptr};
  connection_.reset(PQconnectStartParams(keywords, values, 1));
  if (!connection_) throw std::bad_alloc();
  if (PQstatus(connection_.get()) == CONNECTION_BAD) DemandOptions();
  Connect();
}

void Server::DemandOptions() const {
  // Before it knows as whom to ask, or with these first words, libpq complains of its options alone: a
  // service that is in no file, a port that is none, an sslmode that it does not know, fewer ports than
  // hosts.
  const std::string words = FirstLine(PQerrorMessage(connection_.get()));
  const bool of_options = words.starts_with("invalid ") || words.starts_with("could not match ");
  if (PQuser(connection_.get()) != nullptr && !of_options) return;
  throw ServerError(
      ServerError::Kind::kRefused, "",
      fmt::format("{}: error: {} (expected a service of ~/.pg_service.conf, or options that libpq knows)",
                  shown_, words));
}

void Server::Connect() {
  const std::int64_t since_ms = SteadyMilliseconds();
  // For the SQLSTATE in what it says of a connection that fails.
  PQsetErrorVerbosity(connection_.get(), PQERRORS_VERBOSE);
  PostgresPollingStatusType status =
      PQstatus(connection_.get()) == CONNECTION_BAD ? PGRES_POLLING_FAILED : PGRES_POLLING_WRITING;
  while (status != PGRES_POLLING_OK && status != PGRES_POLLING_FAILED) {
    WaitForSocket(status == PGRES_POLLING_WRITING, since_ms, patience_.to_connect);
    status = PQconnectPoll(connection_.get());
  }
  if (status == PGRES_POLLING_FAILED) {
    const ConnectFailure failure = ReadConnectFailure(PQerrorMessage(connection_.get()));
    // 28: whom the server does not know; 3D000: no such database.
    const bool needs_password = PQconnectionNeedsPassword(connection_.get()) != 0;
    const auto kind = needs_password ? ServerError::Kind::kRefused : KindOfSqlstate(failure.sqlstate);
    throw ServerError(
        kind, failure.sqlstate,
        fmt::format("{}: error: {} (expected {})", shown_, failure.words,
                    kind == ServerError::Kind::kAway ? "a PostgreSQL server that answers there"
                    : needs_password
                        ? "a password for it in ~/.pgpass, or in the file that passfile= or PGPASSFILE names"
                        : "a role and a database that the server knows, and the role's password"));
  }
  PQsetErrorVerbosity(connection_.get(), PQERRORS_DEFAULT);
  PQsetNoticeProcessor(
      connection_.get(), [](void*, const char*) {}, nullptr);
  if (PQsetnonblocking(connection_.get(), 1) != 0) Fail(nullptr);
}

void Server::WaitForSocket(bool for_writing, std::int64_t since_ms,
                           std::chrono::milliseconds patience) const {
  const short events = static_cast<short>(POLLIN | (for_writing ? POLLOUT : 0));
  while (true) {
    if (is_to_end_ && is_to_end_()) {
      throw ServerError(ServerError::Kind::kStopped, "", fmt::format("{}: waited for no longer", shown_));
    }
    pollfd socket{PQsocket(connection_.get()), for_writing ? events : static_cast<short>(POLLIN), 0};
    const int ready = ::poll(&socket, 1, static_cast<int>(kLook_ms));
    if (ready > 0 || (ready < 0 && errno != EINTR)) return;
    if (SteadyMilliseconds() - since_ms > patience.count()) {
      throw ServerError(
          ServerError::Kind::kAway, "",
          fmt::format("{}: error: the server has said nothing for {:.3g} s (expected a PostgreSQL server "
                      "that answers)",
                      shown_, std::chrono::duration<double>(patience).count()));
    }
  }
}

void Server::Flush() {
  while (true) {
    const int left = PQflush(connection_.get());
    if (left < 0) Fail(nullptr);
    if (left == 0) return;
    WaitForSocket(true, SteadyMilliseconds(), patience_.to_answer);
    // A server that has something to say may take no more until it is heard.
    if (PQconsumeInput(connection_.get()) == 0) Fail(nullptr);
  }
}

void Server::Fail(const pg_result* result) const {
  const char* const state = result == nullptr ? nullptr : PQresultErrorField(result, PG_DIAG_SQLSTATE);
  const char* const words = result == nullptr ? nullptr : PQresultErrorField(result, PG_DIAG_MESSAGE_PRIMARY);
  const char* const detail = result == nullptr ? nullptr : PQresultErrorField(result, PG_DIAG_MESSAGE_HINT);
  const std::string sqlstate = state == nullptr ? "" : state;
  if (words == nullptr) {
    throw ServerError(ServerError::Kind::kAway, "",
                      fmt::format("{}: error: {} (expected a PostgreSQL server that goes on answering)",
                                  shown_, FirstLine(PQerrorMessage(connection_.get()))));
  }
  throw ServerError(KindOfSqlstate(sqlstate), sqlstate,
                    fmt::format("{}: error: {}{}", shown_, words,
                                detail == nullptr ? "" : fmt::format(" (expected {})", detail)));
}

// The last result counts, and the first that failed more than that.
ServerRows Server::Answer() {
  std::optional<ServerRows> failed;
  pg_result* failure = nullptr;
  std::optional<ServerRows> last;
  while (true) {
    while (PQisBusy(connection_.get()) != 0) {
      WaitForSocket(false, SteadyMilliseconds(), patience_.to_answer);
      if (PQconsumeInput(connection_.get()) == 0) Fail(nullptr);
    }
    pg_result* const result = PQgetResult(connection_.get());
    if (result == nullptr) break;
    const ExecStatusType status = PQresultStatus(result);
    if (status == PGRES_FATAL_ERROR || status == PGRES_BAD_RESPONSE) {
      if (!failed) failure = result;
      if (!failed)
        failed.emplace(result);
      else
        PQclear(result);
    } else {
      last.emplace(result);
    }
    if (PQstatus(connection_.get()) == CONNECTION_BAD) break;
  }
  if (failed) Fail(failure);
  if (!last) Fail(nullptr);
  return std::move(*last);
}

ServerRows Server::Run(const std::string& sql, std::span<const ServerValue> values) {
  std::vector<const char*> texts;
  for (const ServerValue& value : values) texts.push_back(value ? value->c_str() : nullptr);
  if (PQsendQueryParams(connection_.get(), sql.c_str(), static_cast<int>(texts.size()), nullptr, texts.data(),
                        nullptr, nullptr, 0) == 0) {
    Fail(nullptr);
  }
  Flush();
  return Answer();
}

ServerRows Server::Run(const std::string& sql, std::initializer_list<ServerValue> values) {
  return Run(sql, std::span<const ServerValue>(values.begin(), values.size()));
}

void Server::Execute(const std::string& sql) {
  if (PQsendQuery(connection_.get(), sql.c_str()) == 0) Fail(nullptr);
  Flush();
  Answer();
}

std::string Server::Identifier(const std::string& name) const {
  char* const quoted = PQescapeIdentifier(connection_.get(), name.data(), name.size());
  if (quoted == nullptr) Fail(nullptr);
  std::string text = quoted;
  PQfreemem(quoted);
  return text;
}

std::string Server::Verifier(const std::string& role, const std::string& password) const {
  char* const verifier =
      PQencryptPasswordConn(connection_.get(), password.c_str(), role.c_str(), "scram-sha-256");
  if (verifier == nullptr) Fail(nullptr);
  std::string text = verifier;
  PQfreemem(verifier);
  return text;
}

int Server::version() const { return PQserverVersion(connection_.get()); }

bool Server::IsInTransaction() const {
  const PGTransactionStatusType status = PQtransactionStatus(connection_.get());
  return status == PQTRANS_INTRANS || status == PQTRANS_INERROR;
}

ServerTransaction::ServerTransaction(Server& server) : server_(server) { server_.Execute("BEGIN"); }

ServerTransaction::~ServerTransaction() {
  // A connection that is lost, or in the midst of something, rolls back when it ends.
  if (!open_ || !server_.IsInTransaction()) return;
  try {
    server_.Execute("ROLLBACK");
  } catch (const ServerError&) {
    // The connection is of no more use, and whoever undoes this one has said why.
  }
}

void ServerTransaction::Commit() {
  server_.Execute("COMMIT");
  open_ = false;
}

}  // namespace strainwave::bench
