// SPDX-License-Identifier: Apache-2.0
// Any body of an action asked for on the page: what an operator may do, with the token of this run, or
// nothing.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <variant>

#include "bench/page/actions.h"

using namespace strainwave::bench;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Tokens tokens("key");
  CampaignSnapshot snapshot;
  snapshot.run = "run";
  Actor actor;
  actor.user = User{"operator", UserRole::kOperator, ""};
  actor.session = "session";
  std::string body(reinterpret_cast<const char*>(data), size);
  // A token that no fuzzer guesses, where the body has room for one.
  constexpr std::string_view kPlace = "TOKEN";
  if (const std::size_t at = body.find(kPlace); at != body.npos)
    body.replace(at, kPlace.size(), TokenFor(snapshot, actor, tokens));
  const auto accepted = Accept(body, snapshot, actor, tokens);
  if (const auto* asked = std::get_if<AskedAction>(&accepted)) {
    if (asked->action == nullptr || !(asked->shelf_length_s >= 0.0)) std::abort();
  }
  return 0;
}
