// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/comparison.h"

#include <fmt/format.h>

#include <utility>

namespace strainwave::schedules {
namespace {

std::string WrittenIn(const Origins& origins, const Named& value) {
  const auto origin = origins.find(value.path);
  if (origin == origins.end() || origin->second.text.empty()) return fmt::format("{:g}", value.value);
  return origin->second.text;
}

int LineIn(const Origins& origins, std::string_view path) {
  const auto origin = origins.find(path);
  return origin == origins.end() ? 0 : origin->second.line;
}

}  // namespace

std::string_view KeyOf(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string_view::npos ? path : path.substr(dot + 1);
}

bool Comparison::Readable(std::string_view path) const {
  const auto origin = origins_.find(path);
  return origin == origins_.end() || !origin->second.wrong;
}

std::string Comparison::Written(const Named& value) const { return WrittenIn(origins_, value); }

// A default has no place of its own: its section's is the next best.
Comparison::Place Comparison::PlaceOf(std::string_view path) const {
  while (!path.empty()) {
    const auto origin = origins_.find(path);
    if (origin != origins_.end() && origin->second.line > 0)
      return {origin->second.line, origin->second.column};
    const std::size_t dot = path.find_last_of(".[");
    path = path.substr(0, dot == std::string_view::npos ? 0 : dot);
  }
  return {1, 1};
}

void Comparison::Error(std::string_view path, std::string message) const {
  const Place place = PlaceOf(path);
  findings_.AddError(place.line, place.column, std::move(message));
}

void Comparison::Warning(std::string_view path, std::string message) const {
  const Place place = PlaceOf(path);
  findings_.AddWarning(place.line, place.column, std::move(message));
}

void Comparison::Say(const Named& left, std::string_view relation, const Named& right) const {
  const auto origin = origins_.find(right.path);
  const std::string where = origin == origins_.end()  ? "SI"
                            : origin->second.line > 0 ? fmt::format("line {}", origin->second.line)
                                                      : "default";
  Error(left.path, fmt::format("{} = {} {} {} = {} ({})", KeyOf(left.path), Written(left), relation,
                               KeyOf(right.path), Written(right), where));
}

void Comparison::MustNotExceed(const Named& left, const Named& right) const {
  if (Readable(left.path) && Readable(right.path) && left.value > right.value) Say(left, "is above", right);
}

void Comparison::MustBeBelow(const Named& left, const Named& right) const {
  if (Readable(left.path) && Readable(right.path) && left.value == right.value)
    Say(left, "is not below", right);
  MustNotExceed(left, right);
}

void Comparison::MustReach(const Named& left, const Named& right) const {
  if (Readable(left.path) && Readable(right.path) && left.value < right.value) Say(left, "is below", right);
}

void Comparison::MustNotExceed(const Named& left, std::string_view foreign_name, const Named& right,
                               const Origins& foreign_origins, std::string_view foreign_file) const {
  if (!Readable(left.path) || !(left.value > right.value)) return;
  const int line = LineIn(foreign_origins, right.path);
  const std::string where =
      line > 0 ? fmt::format("{}, line {}", foreign_file, line) : std::string(foreign_file);
  Error(left.path, fmt::format("{} = {} is above {} = {} ({})", KeyOf(left.path), Written(left), foreign_name,
                               WrittenIn(foreign_origins, right), where));
}

}  // namespace strainwave::schedules
