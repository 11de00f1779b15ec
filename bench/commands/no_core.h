// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace strainwave::bench {

/// From now on this process, and what it starts, leaves no memory on the disk when it crashes: it holds
/// passwords, keys or sessions. Whoever looks for the cause of a crash runs it in a debugger.
/// docs/threats.md#secrets says which programs do so.
void LeaveNoCore() noexcept;

}  // namespace strainwave::bench
