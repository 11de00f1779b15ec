// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/errors/bench_error.h"
#include "daq/record.h"

namespace strainwave::bench {

/// `FILE: error: WHAT`, with the group of an HDF5 file: what a record is refused with.
BenchError RecordRefusal(const daq::Record& record, const std::string& what);

/// `FILE:LINE: error: WHAT` where the file has lines: what one of its rows, from 0, is refused with.
BenchError RowRefusal(const daq::Record& record, std::size_t row, const std::string& what);

}  // namespace strainwave::bench
