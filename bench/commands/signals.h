// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>

namespace strainwave::bench {

/// From now on no signal that can be caught ends or stops the process, and none interrupts a call: all
/// threads that start later hold them back, and one of their own takes them and calls `on_signal`, with the
/// process that has sent it, 0 where that was the kernel. Not among them are those that are not at their
/// default (the SIGHUP of nohup), except SIGINT, SIGTERM, SIGUSR1 and SIGUSR2, and those of a terminal in
/// whose background the program is: it writes there all the same. A fault of the program itself (SIGSEGV,
/// SIGABRT, ...) ends it as ever; sent by others, these signals are like the rest.
void ListenToSignals(std::function<void(int signal, pid_t sender)> on_signal);

}  // namespace strainwave::bench
