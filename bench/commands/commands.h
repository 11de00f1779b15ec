// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace strainwave::bench {

/// What a chosen command does; returns the process's exit code.
using Action = std::function<int()>;

/// Each adds its command with options and help to `app`, and sets `action` when it was chosen.
void AddValidate(CLI::App& app, Action& action);
void AddRun(CLI::App& app, Action& action);
void AddDevices(CLI::App& app, Action& action);
void AddBench(CLI::App& app, Action& action);
void AddDriveProfile(CLI::App& app, Action& action);
void AddStatus(CLI::App& app, Action& action);
void AddServe(CLI::App& app, Action& action);
void AddAlarms(CLI::App& app, Action& action);
void AddNote(CLI::App& app, Action& action);
void AddUsers(CLI::App& app, Action& action);
void AddWatch(CLI::App& app, Action& action);
void AddCentral(CLI::App& app, Action& action);
void AddStop(CLI::App& app, Action& action);
void AddRecompute(CLI::App& app, Action& action);
void AddDiagnose(CLI::App& app, Action& action);
void AddTrain(CLI::App& app, Action& action);
void AddBaseline(CLI::App& app, Action& action);
void AddPredict(CLI::App& app, Action& action);
void AddExport(CLI::App& app, Action& action);
void AddMonitor(CLI::App& app, Action& action);
void AddConvert(CLI::App& app, Action& action);
void AddTable(CLI::App& app, Action& action);
void AddVerify(CLI::App& app, Action& action);
void AddSimulate(CLI::App& app, Action& action);
void AddFeatures(CLI::App& app, Action& action);
void AddHealth(CLI::App& app, Action& action);
void AddFaults(CLI::App& app, Action& action);
void AddLife(CLI::App& app, Action& action);
void AddReport(CLI::App& app, Action& action);
void AddFleet(CLI::App& app, Action& action);
void AddFingerprint(CLI::App& app, Action& action);

}  // namespace strainwave::bench
