// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "bench/errors/bench_error.h"

struct pg_conn;
struct pg_result;

namespace strainwave::bench {

/// What a PostgreSQL server has said, or why nothing comes of it.
class ServerError : public BenchError {
 public:
  enum class Kind {
    kAway,     // not reached, going down, out of room, busy: the same may succeed later
    kRefused,  // wrong user, right, database or statement: the same will fail again
    kStopped,  // whoever waited was asked to end
  };

  ServerError(Kind kind, std::string sqlstate, const std::string& sentence);

  Kind kind() const { return kind_; }
  /// Five characters (PostgreSQL, appendix A); empty where no server has answered.
  const std::string& sqlstate() const { return sqlstate_; }

 private:
  Kind kind_;
  std::string sqlstate_;
};

/// Whether a later attempt may succeed where a statement has ended so (PostgreSQL 15, appendix A).
ServerError::Kind KindOfSqlstate(std::string_view sqlstate);

/// The rows of one statement.
class ServerRows {
 public:
  explicit ServerRows(pg_result* result);

  int count() const;
  /// How many rows the statement has written.
  std::int64_t affected() const;
  bool IsNull(int row, int column) const;
  std::string_view View(int row, int column) const;  // as long as this lives; empty for NULL
  std::string Text(int row, int column) const { return std::string(View(row, column)); }
  std::int64_t Integer(int row, int column) const;
  double Real(int row, int column) const;
  bool Truth(int row, int column) const { return View(row, column) == "t"; }

 private:
  struct Clear {
    void operator()(pg_result* result) const;
  };
  std::unique_ptr<pg_result, Clear> result_;
};

/// A value of a statement's parameter; nothing: NULL.
using ServerValue = std::optional<std::string>;

/// Where libpq finds a server: "host=... dbname=... user=...", a URI, or "service=NAME".
/// @throws BenchError (exit code 2) for what libpq cannot read, and for a password in it: everybody on the
///   machine sees the command line. Passwords come from ~/.pgpass, PGPASSFILE or a service file.
void CheckConninfo(const std::string& conninfo);
/// The same without what nobody needs to see, for messages: host, port, database, user.
std::string ShownConninfo(const std::string& conninfo);

/// How long a server is waited for.
struct ServerPatience {
  std::chrono::milliseconds to_connect{30'000};
  std::chrono::milliseconds to_answer{120'000};  // in which it says nothing
};

/// One connection. Every wait ends when the caller is asked to end, and with `kAway` when patience does. Not
/// for several threads at a time.
class Server {
 public:
  /// @param is_to_end  asked several times a second while the server is waited for.
  /// @throws ServerError; `kRefused` for a conninfo that leads nowhere, such as a service that nobody knows.
  explicit Server(const std::string& conninfo, std::function<bool()> is_to_end = {},
                  const ServerPatience& patience = {});

  /// One statement with its parameters $1, $2 and so on. @throws ServerError.
  ServerRows Run(const std::string& sql, std::span<const ServerValue> values = {});
  ServerRows Run(const std::string& sql, std::initializer_list<ServerValue> values);
  /// One statement or several, without parameters.
  void Execute(const std::string& sql);

  /// A name as part of a statement.
  std::string Identifier(const std::string& name) const;
  /// What the server keeps of a password (SCRAM), so that the password itself is in no statement and no log.
  std::string Verifier(const std::string& role, const std::string& password) const;
  int version() const;  // 150018 for 15.18
  /// Whether it is in a transaction and waits for the next statement.
  bool IsInTransaction() const;

 private:
  struct Finish {
    void operator()(pg_conn* connection) const;
  };
  void Connect();
  /// What libpq has refused before it has asked anybody. @throws ServerError.
  void DemandOptions() const;
  /// @param for_writing  the socket must take bytes, too.
  /// @param since_ms  steady milliseconds from which on `patience` counts.
  void WaitForSocket(bool for_writing, std::int64_t since_ms, std::chrono::milliseconds patience) const;
  void Flush();
  ServerRows Answer();
  [[noreturn]] void Fail(const pg_result* result) const;

  std::string shown_;
  std::function<bool()> is_to_end_;
  ServerPatience patience_;
  std::unique_ptr<pg_conn, Finish> connection_;
};

/// Rolled back unless committed.
class ServerTransaction {
 public:
  explicit ServerTransaction(Server& server);
  ServerTransaction(const ServerTransaction&) = delete;
  ServerTransaction& operator=(const ServerTransaction&) = delete;
  ~ServerTransaction();
  void Commit();

 private:
  Server& server_;
  bool open_{true};
};

}  // namespace strainwave::bench
