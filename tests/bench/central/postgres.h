// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fmt/core.h>

#include "bench/central/schema.h"
#include "bench/central/server.h"

namespace strainwave {

inline constexpr const char* kPostgresPrograms = "/usr/lib/postgresql/15/bin/";
inline constexpr const char* kNoPostgres = "skipped, because postgresql-15 is not installed";
inline bool HasPostgres() { return ::access((std::string(kPostgresPrograms) + "initdb").c_str(), X_OK) == 0; }

/// A PostgreSQL server of its own, on a socket in a folder of its own; both are gone when this is. PostgreSQL
/// does not run as root: root runs it as nobody. Its superuser is "admin".
class PostgresServer {
 public:
  /// @param data  where its data is to lie; empty: below its own folder.
  explicit PostgresServer(std::filesystem::path data = {}, const std::string& more_settings = "") {
    std::string name = (std::filesystem::temp_directory_path() / "strainwave-pg-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
    data_ = data.empty() ? folder_ / "data" : data;
    std::filesystem::create_directories(data_);
    for (const std::filesystem::path& path : {folder_, data_}) {
      if (::geteuid() == 0 && ::chown(path.c_str(), kNobody, kNogroup) != 0)
        throw std::runtime_error("chown failed");
      std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    }
    const pid_t made = Spawn({"initdb", "-D", data_, "-U", "admin", "--auth=trust", "--no-sync",
                              "--encoding=UTF8", "--locale=C.UTF-8", "--wal-segsize=1"});
    int status = 0;
    ::waitpid(made, &status, 0);
    if (status != 0) throw std::runtime_error("initdb failed: " + Log());
    std::ofstream(data_ / "postgresql.conf", std::ios::app)
        << "listen_addresses = ''\nunix_socket_directories = '" << folder_.string()
        << "'\nmin_wal_size = 2MB\nmax_wal_size = 16MB\nshared_buffers = 16MB\nfsync = off\n"
        << more_settings << "\n";
    Start();
  }
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;
  ~PostgresServer() {
    if (process_ > 0) End(SIGQUIT);
    std::error_code gone;
    std::filesystem::remove_all(folder_, gone);
  }

  /// Waits until it takes connections. After a kill its old processes may still hold the data for a moment.
  void Start() {
    for (int attempt = 0; attempt < 600; ++attempt) {
      if (process_ > 0 && ::waitpid(process_, nullptr, WNOHANG) == process_) process_ = 0;
      if (process_ == 0) process_ = Spawn({"postgres", "-D", data_});
      try {
        bench::Server server(Conninfo("admin", "postgres"));
        return;
      } catch (const bench::ServerError&) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
    }
    throw std::runtime_error("postgres does not start: " + Log());
  }
  /// With all that it has started, in the midst of whatever they do.
  void Kill() {
    const std::vector<pid_t> children = Children();
    ::kill(process_, SIGKILL);
    for (const pid_t child : children) ::kill(child, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = 0;
  }
  void Stop() { End(SIGINT); }

  std::string Conninfo(const std::string& role, const std::string& database = "lab") const {
    return fmt::format("host={} dbname={} user={}", folder_.string(), database, role);
  }
  /// The database "lab" anew, with its tables and nobody's role.
  void MakeLab(int version = bench::kSchemaVersion) {
    if (process_ == 0) Start();
    bench::Server admin(Conninfo("admin", "postgres"));
    admin.Execute("DROP DATABASE IF EXISTS lab WITH (FORCE)");
    const bench::ServerRows roles =
        admin.Run("SELECT rolname FROM pg_roles WHERE rolname ~ '^(bench|reader)_'");
    for (int i = 0; i < roles.count(); ++i) admin.Execute("DROP ROLE " + admin.Identifier(roles.Text(i, 0)));
    admin.Execute("CREATE DATABASE lab");
    bench::Server lab(Conninfo("admin"));
    bench::Migrate(lab, version);
  }
  /// From now on of every role but "admin", by SCRAM; this process gives that one.
  void DemandPasswords(const std::string& password) {
    std::ofstream(data_ / "pg_hba.conf") << "local all admin trust\nlocal all all scram-sha-256\n";
    bench::Server(Conninfo("admin")).Execute("SELECT pg_reload_conf()");
    ::setenv("PGPASSWORD", password.c_str(), 1);
  }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  static constexpr uid_t kNobody = 65534;
  static constexpr gid_t kNogroup = 65534;

  pid_t Spawn(const std::vector<std::string>& words) const {
    const pid_t process = ::fork();
    if (process != 0) return process;
    const int log = ::open((folder_ / "log").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
    ::dup2(log, STDOUT_FILENO);
    ::dup2(log, STDERR_FILENO);
    if (::geteuid() == 0 && (::setgid(kNogroup) != 0 || ::setuid(kNobody) != 0)) ::_exit(126);
    if (::chdir("/") != 0) ::_exit(126);
    ::setenv("LC_ALL", "C.UTF-8", 1);
    const std::string program = kPostgresPrograms + words.front();
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    ::execv(program.c_str(), arguments.data());
    ::_exit(127);
  }

  std::vector<pid_t> Children() const {
    std::ifstream file(fmt::format("/proc/{0}/task/{0}/children", process_));
    std::vector<pid_t> children;
    for (pid_t child{}; file >> child;) children.push_back(child);
    return children;
  }

  void End(int signal) {
    ::kill(process_, signal);
    ::waitpid(process_, nullptr, 0);
    process_ = 0;
  }

  std::string Log() const {
    std::ifstream file(folder_ / "log");
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::filesystem::path folder_;
  std::filesystem::path data_;
  pid_t process_{};
};

}  // namespace strainwave
