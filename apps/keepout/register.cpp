// SPDX-License-Identifier: BSD-3-Clause

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <ostream>
#include <string>
#include <vector>

#include "commands.h"
#include "keepout/control/rigid_fit.h"
#include "keepout/control/target_error.h"
#include "keepout/error.h"
#include "keepout/mesh/diagnostics.h"
#include "shared/columns.h"
#include "shared/number_text.h"
#include "shared/output_file.h"
#include "shared/pose_file.h"

namespace keepout::app {
namespace {

struct PairRow {
  std::size_t line;  // of the file, from 1
  double residual;   // [mm]
  bool is_worst;
};

struct TargetRow {
  Vec3 place;  // [mm]
  TargetError error;
  double margin;  // [mm]
};

std::string four_decimals(const Json& number) { return formatted("%.4f", number.get<double>()); }

std::string place_text(const Json& place) {
  return formatted("%g, %g, %g", place[0].get<double>(), place[1].get<double>(),
                   place[2].get<double>());
}

std::string worst_text(const Json& is_worst) { return is_worst.get<bool>() ? " the worst" : ""; }

const Columns<PairRow> pair_columns{
    {"line", &PairRow::line, "line", 6},
    {"residual", &PairRow::residual, "apart, mm", 12, &four_decimals},
    {"is_worst", &PairRow::is_worst, "", -1, &worst_text}};

const Columns<TargetRow> target_columns{
    {"target", [](const TargetRow& row) { return json_of(row.place); }, "target, mm", -24,
     &place_text},
    {"tre", [](const TargetRow& row) { return row.error.rms(); }, "TRE, mm", 9, &four_decimals},
    {"worst_deviation", [](const TargetRow& row) { return row.error.worst_deviation(); },
     "one way, mm", 12, &four_decimals},
    {"margin", &TargetRow::margin, "margin, mm", 11, &four_decimals}};

RigidFit fit_of(const FiducialPairs& pairs, const RegisterOptions& options) {
  std::vector<Vec3> measured = pairs.measured;
  for (Vec3& p : measured) p *= options.unit == LengthUnit::metre ? 1000.0 : 1.0;
  try {
    return fit_rigid(measured, pairs.model, pairs.weights);
  } catch (const Error& error) {
    throw Error(options.fiducials.string() + ": " + error.what());
  }
}

/// Returns the largest extent of points along an axis. [mm]
double extent_of(const std::vector<Vec3>& points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& point : points) box.extend(point);
  return box.sizes().maxCoeff();
}

}  // namespace

int register_fiducials(const RegisterOptions& options, std::ostream& out) {
  const std::vector<NamedPath> inputs{{"FILE", options.fiducials}};
  OutputFiles outputs(inputs, {{"--json", options.json}});
  const FiducialPairs pairs = read_fiducials(options.fiducials);
  const RigidFit fit = fit_of(pairs, options);
  std::string doubt = fit.doubt;
  const bool is_in_metres = options.unit == LengthUnit::metre;
  if (std::abs(std::log(fit.scale * (is_in_metres ? 1000.0 : 0.001))) < 0.1) {
    doubt += is_in_metres ? " If the measured ones are in mm, leave out --measured-in m"
                          : " If the measured ones are in meters, give --measured-in m";
  }
  if (doubt.empty() && options.fle) doubt = fit.doubt_of(*options.fle);
  if (const double extent = extent_of(pairs.model);
      doubt.empty() && extent < MeshFindings::meters_below) {
    doubt = "the points of the model are within " + formatted("%g", extent) +
            " mm of each other: give both sides in mm";
  }
  if (doubt.empty() && !options.fle) {
    try {
      target_error(fit, fit.center);
    } catch (const Error& error) {
      doubt = error.what();
    }
  }
  if (!doubt.empty()) std::cerr << "keepout: do not trust this registration: " << doubt << '\n';
  const double largest = std::ranges::max(fit.residuals);
  std::vector<PairRow> rows;
  for (std::size_t i = 0; i < fit.residuals.size(); ++i) {
    rows.push_back({pairs.lines[i], fit.residuals[i], fit.residuals[i] == largest});
  }
  const bool is_trusted = doubt.empty() || options.trusted_anyway;
  std::vector<Vec3> places;
  std::vector<TargetRow> targets;
  const auto margin_of = [&](const std::vector<Vec3>& of) {
    return registration_margin(fit, of, options.confidence, options.fle);
  };
  for (std::size_t i = 0; is_trusted && i < options.targets.size(); i += 3) {
    const double* const xyz = &options.targets[i];
    places.emplace_back(xyz[0], xyz[1], xyz[2]);
    targets.push_back(
        {places.back(), target_error(fit, places.back(), options.fle), margin_of({places.back()})});
  }
  const Eigen::Matrix4d m = fit.matrix();
  Json json{{"unit", "mm"}, {"mesh_from_robot", Json::array()}};

  out << "From the robot's frame to the mesh's, the translation in mm\n";
  for (int i = 0; i < 4; ++i) {
    out << formatted("%16.12f%16.12f%16.12f%18.9f\n", m(i, 0), m(i, 1), m(i, 2), m(i, 3));
    json["mesh_from_robot"].push_back({m(i, 0), m(i, 1), m(i, 2), m(i, 3)});
  }
  out << "\nResiduals of the " << counted(rows.size(), "pair") << '\n';
  print_rows(out, pair_columns, rows);
  const double fle = options.fle.value_or(fit.estimated_fle());
  out << formatted("\nFRE %.4f mm%s; FLE %.4f mm, ", fit.fre,
                   pairs.weights.empty() ? "" : " by weight", fle)
      << (options.fle ? formatted("as given (the FRE suggests %.4f)\n", fit.estimated_fle())
                      : "estimated from the FRE\n");
  json.update({{"pairs", json_of(pair_columns, rows)},
               {"fre", fit.fre},
               {"fle", fle},
               {"fle_is_estimated", !options.fle},
               {"scale", fit.scale},
               {"doubt", doubt},
               {"confidence", options.confidence},
               {"targets", json_of(target_columns, targets)},
               {"margin", places.empty() ? Json(nullptr) : Json(margin_of(places))}});
  if (!is_trusted) {
    out << "No margin: the registration is in doubt. --anyway computes one.\n";
  } else if (places.empty()) {
    out << "No margin: give the places in the mesh where the tool works, with --target X Y Z.\n";
  } else {
    print_rows(out, target_columns, targets);
    out << formatted(
        "Add %.4f mm to a guard's margin: the registration error%s is no larger,\nwith a "
        "probability of %g%s.\n",
        json["margin"].get<double>(), places.size() == 1 ? " there" : " at all of them and between",
        options.confidence, doubt.empty() ? "" : ", if the registration can be trusted");
  }
  if (std::ostream* file = outputs.stream("--json")) *file << json.dump(2) << '\n';
  outputs.commit();
  return is_trusted ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace keepout::app
