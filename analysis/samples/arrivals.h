// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace strainwave::analysis::samples {

/// When the new values of a held channel came. Values that come evenly, but between rows, are up to a row
/// late where they are written first: half a row before the even times that the rows stand for. Otherwise the
/// rows' own times.
/// @param fresh  true in rows with a new value.
/// @return one time a row; those of rows without a new value mean nothing.
std::vector<double> ArrivalTimes(std::span<const double> time_s, const std::vector<bool>& fresh);

/// Another channel at those times: on straight lines between its own new values.
/// @param own      true in rows with a new value of this channel.
/// @param wanted   true in the rows whose value is asked for.
std::vector<double> AtArrivals(std::span<const double> time_s, std::span<const double> values,
                               const std::vector<bool>& own, std::span<const double> arrival_s,
                               const std::vector<bool>& wanted);

}  // namespace strainwave::analysis::samples
