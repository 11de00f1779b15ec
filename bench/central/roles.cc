// SPDX-License-Identifier: Apache-2.0
#include "bench/central/roles.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fmt/core.h>

#include "bench/accounts/random_bytes.h"
#include "bench/errors/output_path.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kPassword_bytes = 24;
constexpr std::size_t kLongestName = 50;  // with its prefix a role has at most 63 bytes (NAMEDATALEN)

bool IsRoleName(const std::string& name) {
  const auto allowed = [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
           (letter >= '0' && letter <= '9') || letter == '_' || letter == '-' || letter == '.';
  };
  return !name.empty() && name.size() <= kLongestName && std::ranges::all_of(name, allowed);
}

// For its owner alone from the first byte on: libpq does not read one that others may.
class PasswordFile {
 public:
  PasswordFile(const std::filesystem::path& file, const std::string& line) : file_(file) {
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (descriptor < 0) {
      if (errno == EEXIST) Refuse(file, "is there already", "the name of a file to be made");
      throw std::system_error(errno, std::generic_category(), file.string());
    }
    const bool whole = ::write(descriptor, line.data(), line.size()) == static_cast<ssize_t>(line.size()) &&
                       ::fsync(descriptor) == 0;
    const int failure = errno;
    ::close(descriptor);
    if (whole) return;
    Remove();
    throw std::system_error(failure, std::generic_category(), file.string());
  }
  PasswordFile(const PasswordFile&) = delete;
  PasswordFile& operator=(const PasswordFile&) = delete;
  ~PasswordFile() {
    if (!kept_) Remove();
  }
  void Keep() { kept_ = true; }

 private:
  void Remove() {
    std::error_code gone;
    std::filesystem::remove(file_, gone);
  }

  std::filesystem::path file_;
  bool kept_{};
};

std::string_view GroupOf(RoleKind kind) {
  switch (kind) {
    case RoleKind::kBench:
      return "strainwave_bench";
    case RoleKind::kReader:
      return "strainwave_reader";
  }
  return {};
}

}  // namespace

std::string RoleOf(RoleKind kind, const std::string& name) {
  return (kind == RoleKind::kBench ? "bench_" : "reader_") + name;
}

std::string MakeRole(Server& server, const RoleOrder& order) {
  if (!IsRoleName(order.name)) {
    Refuse("NAME", fmt::format("'{:.60}' is no name of a bench or reader", order.name),
           fmt::format("letters, digits, '_', '-' and '.', {} at most", kLongestName));
  }
  if (!order.passfile.empty()) DemandOutputFile(order.passfile);
  const std::string role = RoleOf(order.kind, order.name);
  ServerTransaction transaction(server);
  const bool there = server.Run("SELECT 1 FROM pg_roles WHERE rolname = $1", {role}).count() > 0;
  if (order.new_machine) {
    const ServerRows changed =
        server.Run("UPDATE strainwave.benches SET machine = NULL WHERE name = $1 RETURNING 1", {order.name});
    if (changed.count() == 0)
      Refuse("NAME", fmt::format("there is no bench {}", order.name), "one that is there");
    if (!order.new_password) {
      transaction.Commit();
      return fmt::format("bench {}: the next machine that forwards for it is taken for its own", order.name);
    }
  }
  if (there && !order.new_password)
    Refuse("NAME", fmt::format("there is a role {} already", role), "another name, or --new-password");
  if (!there && order.new_password)
    Refuse("NAME", fmt::format("there is no role {}", role), "one that is there");
  const std::string password = HexOf(RandomBytes(kPassword_bytes));
  PasswordFile file(order.passfile, fmt::format("*:*:*:{}:{}\n", role, password));
  const std::string quoted = server.Identifier(role);
  server.Execute(fmt::format("{} ROLE {} LOGIN PASSWORD '{}'", there ? "ALTER" : "CREATE", quoted,
                             server.Verifier(role, password)));
  if (!there) {
    server.Execute(fmt::format("GRANT {} TO {}", GroupOf(order.kind), quoted));
    if (order.kind == RoleKind::kBench)
      server.Run("INSERT INTO strainwave.benches(name, role) VALUES ($1, $2)", {order.name, role});
  }
  transaction.Commit();
  file.Keep();
  return fmt::format("role {}: {}; its password is in {} and nowhere else", role,
                     there ? "a new password" : "made", order.passfile.string());
}

}  // namespace strainwave::bench
