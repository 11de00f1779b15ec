// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace strainwave::bench {

inline constexpr const char* kActionsPath = "/api/v1/actions";
inline constexpr const char* kLoginPath = "/api/v1/login";
inline constexpr const char* kLogoutPath = "/api/v1/logout";

/// Who may look at the page. Where it is served to this machine alone, everybody; where other machines reach
/// it, who is logged in.
class PageGate {
 public:
  /// @param address  where it is served; @param names  of this machine, by which others call it.
  PageGate(std::string_view address, std::vector<std::string> names);

  /// Whether everybody may look who reaches the page.
  bool is_open() const { return is_open_; }

  /// Whether the path is for who is logged in alone: all but the page's own files, which hold nothing of a
  /// campaign, and the login.
  bool IsGuarded(std::string_view path) const;

  /// What is wrong with the name that a request calls this machine by; nothing: it is one of its own. A page
  /// of elsewhere whose name was made to lead here (DNS rebinding) has another, and an address leads to
  /// nobody else.
  /// @param host  header Host; @param own_address  to which the connection was made.
  std::optional<std::string> WrongHost(std::string_view host, std::string_view own_address) const;

 private:
  bool is_open_;
  std::vector<std::string> names_;
};

/// Whether it may be the name of a machine: letters, digits, hyphens, dots; without a port.
bool IsHostName(std::string_view name);

/// "https://192.0.2.7:8443/"; of all addresses of a machine, and no names, that of the loopback.
std::string PageUrl(bool is_encrypted, std::string_view address, const std::vector<std::string>& names,
                    int port);

}  // namespace strainwave::bench
