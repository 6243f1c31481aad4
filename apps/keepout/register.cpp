// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "columns.h"
#include "commands.h"
#include "keepout/control/rigid_fit.h"
#include "keepout/control/target_error.h"
#include "keepout/error.h"
#include "number_text.h"
#include "output_file.h"
#include "pose_file.h"

namespace keepout::app {
namespace {

/// The fiducials' fit, and what was asked of it. [mm]
struct Fitted {
  FiducialPairs pairs;
  RigidFit fit;
  std::vector<Vec3> targets;

  std::size_t worst() const {
    return std::ranges::max_element(fit.residuals) - fit.residuals.begin();
  }
};

Fitted fitted(const RegisterOptions& options) {
  Fitted result{.pairs = read_fiducials(options.fiducials), .fit = {}, .targets = {}};
  if (options.unit == LengthUnit::metre) {
    for (Vec3& p : result.pairs.measured) p *= 1000.0;
  }
  try {
    const FiducialPairs& pairs = result.pairs;
    result.fit = fit_rigid(pairs.measured, pairs.model, pairs.weights);
  } catch (const Error& error) {
    throw Error(options.fiducials.string() + ": " + error.what());
  }
  for (std::size_t i = 0; i < options.targets.size(); i += 3) {
    result.targets.emplace_back(options.targets[i], options.targets[i + 1], options.targets[i + 2]);
  }
  return result;
}

double margin(const RegisterOptions& options, const Fitted& fitted,
              const std::vector<Vec3>& targets) {
  return registration_margin(fitted.fit, targets, options.confidence, options.fle);
}

void print(std::ostream& out, const RegisterOptions& options, const Fitted& fitted) {
  const RigidFit& fit = fitted.fit;
  const std::size_t pairs = fit.residuals.size();
  out << options.fiducials.string() << ": " << counted(pairs, "pair") << "\n\n"
      << "Matrix from the robot's frame to the mesh's, its translation in mm\n";
  const Eigen::Matrix4d matrix = fit.matrix();
  for (int row = 0; row < 4; ++row) {
    out << formatted("  %16.12f %16.12f %16.12f %18.9f\n", matrix(row, 0), matrix(row, 1),
                     matrix(row, 2), matrix(row, 3));
  }
  out << "\nLeft between the pairs, in mm\n";
  for (std::size_t i = 0; i < pairs; ++i) {
    out << formatted("  pair %3zu, line %3zu %10.4f%s\n", i + 1, fitted.pairs.lines[i],
                     fit.residuals[i], i == fitted.worst() ? "  the worst" : "");
  }
  out << formatted("\nFRE %.4f mm, root mean square%s\n", fit.fre,
                   fitted.pairs.weights.empty() ? "" : " by weight")
      << (options.fle ? formatted("FLE %.4f mm, as told; estimated from the FRE: %.4f mm\n",
                                  *options.fle, fit.estimated_fle())
                      : formatted("FLE %.4f mm, estimated from the FRE\n", fit.estimated_fle()));
  for (const Vec3& target : fitted.targets) {
    const TargetError error = target_error(fit, target, options.fle);
    out << formatted(
        "Target %g, %g, %g: TRE %.4f mm, root mean square; %.4f mm in the worst direction, one "
        "standard deviation\n  margin for it: %.4f mm\n",
        target.x(), target.y(), target.z(), error.rms(), error.worst_deviation(),
        margin(options, fitted, {target}));
  }
  if (fitted.targets.empty()) {
    out << "No margin: say where in the mesh the tool works, with --target X Y Z.\n";
  } else {
    out << formatted(
        "Add %.4f mm to the margin of a guard: with a probability of %g the registration is off by "
        "no more\nat %s.\n",
        margin(options, fitted, fitted.targets), options.confidence,
        fitted.targets.size() == 1 ? "the target" : "all targets and everywhere between them");
  }
  if (!fit.doubt.empty()) out << "\nDo not trust it: " << fit.doubt << '\n';
}

Json json_of(const RegisterOptions& options, const Fitted& fitted) {
  const RigidFit& fit = fitted.fit;
  Json rows = Json::array();
  const Eigen::Matrix4d matrix = fit.matrix();
  for (int i = 0; i < 4; ++i) {
    rows.push_back({matrix(i, 0), matrix(i, 1), matrix(i, 2), matrix(i, 3)});
  }
  Json json{{"unit", "mm"},
            {"mesh_from_robot", rows},
            {"residuals", fit.residuals},
            {"lines", fitted.pairs.lines},
            {"worst_line", fitted.pairs.lines[fitted.worst()]},
            {"fre", fit.fre},
            {"fle", options.fle.value_or(fit.estimated_fle())},
            {"fle_is_estimated", !options.fle},
            {"scale", fit.scale},
            {"doubt", fit.doubt},
            {"confidence", options.confidence},
            {"targets", Json::array()},
            {"margin", nullptr}};
  for (const Vec3& target : fitted.targets) {
    const TargetError error = target_error(fit, target, options.fle);
    Json covariance = Json::array();
    for (int i = 0; i < 3; ++i) covariance.push_back(app::json_of(Vec3(error.covariance.row(i))));
    json["targets"].push_back({{"target", app::json_of(target)},
                               {"tre", error.rms()},
                               {"worst_deviation", error.worst_deviation()},
                               {"covariance", covariance},
                               {"margin", margin(options, fitted, {target})}});
  }
  if (!fitted.targets.empty()) json["margin"] = margin(options, fitted, fitted.targets);
  return json;
}

}  // namespace

void register_fiducials(const RegisterOptions& options, std::ostream& out) {
  const std::vector<NamedPath> inputs{{"FILE", options.fiducials}};
  OutputFiles outputs(inputs, {{"--json", options.json}});
  const Fitted result = fitted(options);
  print(out, options, result);
  if (std::ostream* json = outputs.stream("--json")) {
    *json << json_of(options, result).dump(2) << '\n';
  }
  outputs.commit();
}

}  // namespace keepout::app
