// SPDX-License-Identifier: Apache-2.0
#include "analysis/wavelets/packets.h"

#include <fmt/format.h>

#include <bit>
#include <stdexcept>

namespace strainwave::analysis::wavelets {
namespace {

void RequirePacketLevels(int levels) {
  if (levels < 1 || levels > kMostPacketLevels) {
    throw std::invalid_argument(fmt::format("levels = {} is not in 1 to {}", levels, kMostPacketLevels));
  }
}

// Lengths of the nodes from the signal down.
std::vector<std::size_t> Lengths(std::size_t samples, std::size_t filter_length, Border border,
                                 std::size_t levels) {
  std::vector<std::size_t> lengths{samples};
  while (lengths.size() <= levels) lengths.push_back(CoefficientCount(lengths.back(), filter_length, border));
  return lengths;
}

}  // namespace

void DecomposePackets(std::span<const double> signal, const FilterBank& bank, Border border, int levels,
                      Packets& out) {
  RequirePacketLevels(levels);
  const std::size_t count = std::size_t{1} << levels;
  out.leaves.resize(count);
  // A node stands where the first of its leaves will; each level splits it in place.
  out.leaves[0].assign(signal.begin(), signal.end());
  for (std::size_t width = count; width > 1; width /= 2) {
    for (std::size_t node = 0; node < count; node += width) {
      out.spare.swap(out.leaves[node]);
      const std::size_t length = CoefficientCount(out.spare.size(), bank.length(), border);
      out.leaves[node].resize(length);
      out.leaves[node + width / 2].resize(length);
      Transform(out.spare, bank, border, out.leaves[node], out.leaves[node + width / 2]);
    }
  }
}

std::vector<double> ReconstructPackets(const std::vector<std::vector<double>>& leaves, const FilterBank& bank,
                                       Border border, std::size_t samples) {
  if (leaves.size() < 2 || !std::has_single_bit(leaves.size())) {
    throw std::invalid_argument(fmt::format("leaves has {} series (expected a power of two)", leaves.size()));
  }
  const auto levels = static_cast<std::size_t>(std::countr_zero(leaves.size()));
  const std::vector<std::size_t> lengths = Lengths(samples, bank.length(), border, levels);
  std::vector<std::vector<double>> nodes = leaves;
  for (std::size_t level = levels; level-- > 0;) {
    for (std::size_t node = 0; node < nodes.size() / 2; ++node) {
      std::vector<double> fine(SampleCount(nodes[2 * node].size(), bank.length(), border));
      InverseTransform(nodes[2 * node], nodes[2 * node + 1], bank, border, fine);
      if (lengths[level] > fine.size()) {
        throw std::invalid_argument(fmt::format("level {} gives {} samples back (expected {})", level + 1,
                                                fine.size(), lengths[level]));
      }
      fine.resize(lengths[level]);
      nodes[node] = std::move(fine);
    }
    nodes.resize(nodes.size() / 2);
  }
  return nodes.front();
}

std::vector<std::string> PacketPaths(int levels) {
  RequirePacketLevels(levels);
  std::vector<std::string> paths;
  for (std::size_t leaf = 0; leaf < std::size_t{1} << levels; ++leaf) {
    std::string path;
    for (int level = levels; level-- > 0;) path += (leaf >> level & 1U) != 0 ? 'd' : 'a';
    paths.push_back(std::move(path));
  }
  return paths;
}

std::vector<std::size_t> FrequencyOrder(int levels) {
  RequirePacketLevels(levels);
  std::vector<std::size_t> order;
  for (std::size_t band = 0; band < std::size_t{1} << levels; ++band) order.push_back(band ^ band >> 1);
  return order;
}

}  // namespace strainwave::analysis::wavelets
