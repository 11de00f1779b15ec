// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "bench/campaign/campaign.h"
#include "bench/campaign/signed_words.h"
#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/errors/bench_error.h"
#include "bench/escaped.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

struct NoteOptions {
  std::string folder;
  std::string text;
  std::string by;
};

int KeepNote(const NoteOptions& options) {
  const OperatorNote note{UtcNow(), SignerOf(options.by), WordsOf("TEXT", options.text, false)};
  Journal journal = OpenCampaign({options.folder}, Database::Mode::kReadWrite);
  journal.AddOperatorNote(note);
  ToStdout("noted {} by {}: {}\n", note.utc, Escaped(note.author), Escaped(note.text));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddNote(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("note",
                         "Keep a note of a person in the journal of a campaign, running or not; "
                         "status shows the newest.\n"
                         "Example: strainwave note campaigns/first \"grease changed\" --by \"A. "
                         "Meier\"");
  auto options = std::make_shared<NoteOptions>();
  command->add_option("DIR", options->folder, "the campaign's folder")->required();
  command->add_option("TEXT", options->text, "the note")->required();
  command->add_option("--by", options->by, "name of the person whose note it is");
  command->callback([options, &action] { action = [options] { return KeepNote(*options); }; });
}

}  // namespace strainwave::bench
