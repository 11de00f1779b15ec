// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/prediction_picture.h"

#include <fmt/format.h>

#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {

void DrawPredictions(const HeldOut& held_out, const std::vector<std::string>& outputs,
                     const std::filesystem::path& stem) {
  constexpr int kPanelHeight_px = 320;
  std::string script = "$held_out << EOD\n";
  for (Eigen::Index row = 0; row < held_out.actual.rows(); ++row) {
    script += fmt::format("{}", held_out.cycle[static_cast<std::size_t>(row)]);
    for (Eigen::Index column = 0; column < held_out.actual.cols(); ++column) {
      script += fmt::format(" {} {}", held_out.actual(row, column), held_out.predicted(row, column));
    }
    script += "\n";
  }
  script += fmt::format("EOD\nset multiplot layout {},1 title {}\nset grid\nset key outside right top\n",
                        outputs.size(),
                        Quoted("records that the network had not seen: the last part of each life"));
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (i + 1 == outputs.size()) script += "set xlabel 'cycle'\n";
    script += fmt::format(
        "set ylabel {}\nplot $held_out using 1:{} with points pt 7 ps 0.4 lc rgb '{}' title 'measured', "
        "'' using 1:{} with points pt 7 ps 0.4 lc rgb '{}' title 'predicted'\n",
        Quoted(outputs[i]), 2 * i + 2, kFirstColour.plain, 2 * i + 3, kLastColour.plain);
  }
  script += "unset multiplot\n";
  RenderPicture(script, stem, {1200, kPanelHeight_px * static_cast<int>(outputs.size())});
}

}  // namespace strainwave::bench
