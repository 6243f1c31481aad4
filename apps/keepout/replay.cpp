// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdlib>
#include <iostream>
#include <map>
#include <ostream>
#include <vector>

#include "commands.h"
#include "shared/clip.h"
#include "shared/command_line.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/output_file.h"
#include "shared/pose_file.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

void write_step(std::ostream& out, std::size_t number, const Motion& motion, const Step& step,
                const StageTimes& times) {
  const Vec3& p = motion.tip;
  const Vec3& d = motion.desired;
  const Vec3& u = step.motion;
  // 17 significant digits read back exactly.
  out << formatted("%zu,%s,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%zu,%zu,%" PRId64
                   ",%" PRId64 ",%" PRId64 ",%" PRId64 ",",
                   number, name(step.status).data(), p.x(), p.y(), p.z(), d.x(), d.y(), d.z(),
                   u.x(), u.y(), u.z(), step.triangles, step.planes.size(), times.query,
                   times.activation, times.solve, times.total());
  if (step.distance) out << formatted("%.17g", *step.distance);
  out << '\n';
}

void write_planes(std::ostream& out, std::size_t number, const Step& step) {
  for (const HalfSpace& plane : step.planes) {
    out << formatted("%zu,%u,%.17g,%.17g,%.17g,%.17g\n", number, plane.source, plane.normal.x(),
                     plane.normal.y(), plane.normal.z(), plane.offset);
  }
}

}  // namespace

int replay(const ReplayOptions& options, std::ostream& out) {
  const bool closed_loop = options.loop == Loop::closed;
  if (closed_loop) require_within_reach(options.max_step, options.constraint.options.radius);
  OutputFiles outputs(std::array{NamedPath{"MESH", file_of_mesh(options.mesh)},
                                 NamedPath{"--poses", options.poses}},
                      {{"--out", options.steps}, {"--planes", options.planes}});
  const StopSignal stop(keeps_what_is_finished, BeforeWork::ends_process);
  std::ostream& steps = *outputs.stream("--out");
  std::ostream* const planes = outputs.stream("--planes");
  steps << "step,status,px,py,pz,dx,dy,dz,ux,uy,uz,triangles,planes,"
           "t_query_ns,t_activate_ns,t_solve_ns,t_total_ns,distance\n";
  if (planes != nullptr) *planes << "step,triangle,nx,ny,nz,offset\n";
  std::vector<PoseLine> poses;
  LoadedMesh loaded;
  {
    const Progress reading("replay, reading", 1);
    poses = read_poses(options.poses);
    loaded = load_named_mesh(options.mesh, options.load);
  }
  MotionConstraintSettings settings = options.constraint;
  settings.warn = warn_on_stderr;
  MotionConstraint constraint = make_motion_constraint(loaded.mesh, settings);
  constraint.set_guides(guides_of(options.guides, Guided::tip));
  std::size_t limited_by_guides = 0;

  std::map<std::string_view, std::size_t> counts;
  std::size_t number = 0;
  {
    Progress progress("replay", poses.size());
    Vec3 tip = poses.front().second;
    for (; number < poses.size() && !stop.has_come(); ++number, progress.advance()) {
      const PoseLine& line = poses[number];
      const Motion motion =
          closed_loop ? Motion{.tip = tip, .desired = clipped(line.first - tip, options.max_step)}
                      : Motion{.tip = line.first, .desired = line.second};
      StageTimes times;
      const Step step = constraint.step(motion, times);
      limited_by_guides += step.limits.has(Limit::guide) ? 1 : 0;
      write_step(steps, number, motion, step, times);
      if (planes != nullptr) write_planes(*planes, number, step);
      tip += step.motion;
      ++counts[name(step.status)];
      stop.keep_from_now_on();
    }
  }
  outputs.commit();

  out << counted(number, "step") << " -> " << options.steps.string() << '\n';
  for (const auto& [status, count] : counts) out << "  " << status << ": " << count << '\n';
  if (!options.guides.empty()) out << "  limited by guides: " << limited_by_guides << '\n';
  if (number == poses.size()) return EXIT_SUCCESS;
  std::vector<std::string> kept{options.steps.string()};
  if (options.planes) kept.push_back(options.planes->string());
  std::cerr << "keepout: stopped; " << grouped(number) << " of " << counted(poses.size(), "step")
            << " were finished, and are kept in " << listed(kept) << '\n';
  return exit_interrupted;
}

}  // namespace keepout::app
