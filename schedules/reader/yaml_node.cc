// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/yaml_node.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "schedules/reader/unicode_spaces.h"
#include "schedules/reader/yaml_text.h"

namespace strainwave::schedules {
namespace {

constexpr std::size_t kDeepestNesting = 16;
constexpr std::size_t kMostValues = 100'000;

// Ends the parsing at a place that cannot be stepped over.
struct Refusal {
  YAML::Mark mark;
  std::string message;
};

// Builds the tree from the parser's events; the parser's own tree hides doubled keys and follows aliases.
class TreeBuilder final : public YAML::EventHandler {
 public:
  explicit TreeBuilder(FindingList& findings) : findings_(findings) {}

  YamlNode TakeRoot() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) throw Refusal{mark, "a second document begins (expected one in a file)"};
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    RefuseAnchor(mark, anchor);
    Put(mark, YamlNode::Type::kNull);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    findings_.AddError(mark.line + 1, mark.column + 1, "alias (expected the value itself)");
    Put(mark, YamlNode::Type::kNull);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    RefuseAnchor(mark, anchor);
    RefuseTag(mark, tag);
    Put(mark, YamlNode::Type::kScalar).text = value;
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Open(mark, tag, anchor, YamlNode::Type::kSequence);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Open(mark, tag, anchor, YamlNode::Type::kMap);
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  YamlNode& Put(const YAML::Mark& mark, YamlNode::Type type) {
    if (++values_ > kMostValues) {
      throw Refusal{mark, fmt::format("more than {} values (expected a few hundred)", kMostValues)};
    }
    YamlNode node{type, {}, mark.line + 1, mark.column + 1, {}};
    if (open_.empty()) return root_ = std::move(node);
    return open_.back()->children.emplace_back(std::move(node));
  }

  // A pointer into `children` stays good while it is open: only the innermost open node grows.
  void Open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YamlNode::Type type) {
    RefuseAnchor(mark, anchor);
    RefuseTag(mark, tag);
    if (open_.size() >= kDeepestNesting) {
      throw Refusal{mark, fmt::format("nested too deeply (expected at most {} levels)", kDeepestNesting)};
    }
    open_.push_back(&Put(mark, type));
  }

  void RefuseAnchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != 0) findings_.AddError(mark.line + 1, mark.column + 1, "anchor (expected plain values)");
  }

  // The parser reports plain values as "?" and quoted ones as "!". A tag may be half of somebody's password.
  void RefuseTag(const YAML::Mark& mark, const std::string& tag) {
    if (tag.empty() || tag == "?" || tag == "!") return;
    findings_.AddError(mark.line + 1, mark.column + 1,
                       "tag (expected plain values; a text that begins with '!' stands in quotes)");
  }

  FindingList& findings_;
  YamlNode root_;
  std::vector<YamlNode*> open_;
  std::size_t values_{};
  int documents_{};
};

std::string ReadAtMost(std::FILE* file, std::size_t most_bytes) {
  std::string text;
  std::array<char, 1U << 16U> buffer{};
  std::size_t count = 0;
  while (text.size() <= most_bytes && (count = std::fread(buffer.data(), 1, buffer.size(), file)) > 0) {
    text.append(buffer.data(), count);
  }
  return text;
}

}  // namespace

std::optional<std::string> ReadInputFile(const std::filesystem::path& path, const FileKind& kind,
                                         FindingList& findings) {
  const auto refuse = [&](const std::string& reason) {
    findings.AddError(0, 0, fmt::format("cannot be read: {} (expected a {} file)", reason, kind.noun));
    return std::nullopt;
  };
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return refuse("it is a folder");
  if (const auto bytes = std::filesystem::file_size(path, error); !error) {
    if (std::string message = TooLargeMessage(bytes, kind); !message.empty()) {
      findings.AddError(1, 1, std::move(message));
      return std::nullopt;
    }
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (file == nullptr) return refuse(std::generic_category().message(errno));
  constexpr std::size_t kBeyondTheLimit_bytes = std::size_t{2} << 20U;  // the parser's check does the rest
  std::string text = ReadAtMost(file.get(), kBeyondTheLimit_bytes);
  if (std::ferror(file.get()) != 0) return refuse(std::generic_category().message(errno));
  return text;
}

std::optional<YamlNode> ParseYaml(const std::string& text, const FileKind& kind, FindingList& findings) {
  FindingList own;
  CheckYamlText(text, kind, own);
  if (own.has_errors()) {
    findings.Append(own);
    return std::nullopt;
  }
  TreeBuilder builder(own);
  try {
    std::istringstream stream(WithPlainSpaces(text));
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const Refusal& refusal) {
    own.AddError(refusal.mark.line + 1, refusal.mark.column + 1, refusal.message);
  } catch (const YAML::Exception& error) {
    own.AddError(error.mark.line + 1, error.mark.column + 1,
                 fmt::format("not YAML: {} (expected 'key: value' lines)", error.msg));
  }
  YamlNode root = builder.TakeRoot();
  if (!own.has_errors() && root.type != YamlNode::Type::kMap) {
    own.AddError(std::max(root.line, 1), std::max(root.column, 1),
                 fmt::format("not a {} (expected 'key: value' lines that begin with '{}')", kind.noun,
                             kind.first_line));
  }
  findings.Append(own);
  if (own.has_errors()) return std::nullopt;
  return root;
}

}  // namespace strainwave::schedules
