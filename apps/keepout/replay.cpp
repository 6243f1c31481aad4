// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cinttypes>
#include <cstdio>
#include <map>
#include <ostream>
#include <vector>

#include "clip.h"
#include "commands.h"
#include "named_mesh.h"
#include "number_text.h"
#include "output_file.h"
#include "pose_file.h"
#include "progress.h"

namespace keepout::app {
namespace {

/// snprintf into a stream: the shortest way to 17 significant digits, which read back exactly.
template <class... Values>
void print(std::ostream& out, const char* format, Values... values) {
  std::array<char, 512> line;
  const int length = std::snprintf(line.data(), line.size(), format, values...);
  out.write(line.data(), length);
}

void write_step(std::ostream& out, std::size_t number, const Motion& motion, const Step& step,
                const StageTimes& times) {
  const Vec3& p = motion.tip;
  const Vec3& d = motion.desired;
  const Vec3& u = step.motion;
  print(out,
        "%zu,%s,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%zu,%zu,%" PRId64 ",%" PRId64
        ",%" PRId64 ",%" PRId64 ",",
        number, name(step.status).data(), p.x(), p.y(), p.z(), d.x(), d.y(), d.z(), u.x(), u.y(),
        u.z(), step.triangles, step.planes.size(), times.query, times.activation, times.solve,
        times.total());
  if (step.distance) print(out, "%.17g", *step.distance);
  out << '\n';
}

void write_planes(std::ostream& out, std::size_t number, const Step& step) {
  for (const HalfSpace& plane : step.planes) {
    print(out, "%zu,%u,%.17g,%.17g,%.17g,%.17g\n", number, plane.source, plane.normal.x(),
          plane.normal.y(), plane.normal.z(), plane.offset);
  }
}

void require_files_of_their_own(const ReplayOptions& options) {
  const std::array inputs{NamedPath{"MESH", file_of_mesh(options.mesh)},
                          NamedPath{"--poses", options.poses}};
  std::vector<NamedPath> outputs{{"--out", options.steps}};
  if (options.planes) outputs.push_back({"--planes", *options.planes});
  refuse_shared_files(inputs, outputs);
}

}  // namespace

void replay(const ReplayOptions& options, std::ostream& out) {
  const bool closed_loop = options.loop == Loop::closed;
  if (closed_loop) require_within_reach(options.max_step, options.constraint.radius);
  require_files_of_their_own(options);
  OutputFile steps(options.steps);
  steps.stream() << "step,status,px,py,pz,dx,dy,dz,ux,uy,uz,triangles,planes,"
                    "t_query_ns,t_activate_ns,t_solve_ns,t_total_ns,distance\n";
  std::optional<OutputFile> planes;
  if (options.planes) {
    planes.emplace(*options.planes);
    planes->stream() << "step,triangle,nx,ny,nz,offset\n";
  }
  const std::vector<PoseLine> poses = read_poses(options.poses);
  const LoadedMesh loaded = load_named_mesh(options.mesh, options.load);
  MotionConstraintSettings settings = options.constraint;
  settings.warn = warn_on_stderr;
  settings.distances = Distances::always;
  MotionConstraint constraint = make_motion_constraint(loaded.mesh, settings);

  std::map<std::string_view, std::size_t> counts;
  {
    Progress progress("replay", poses.size());
    Vec3 tip = poses.front().second;
    for (std::size_t number = 0; number < poses.size(); ++number, progress.advance()) {
      const PoseLine& line = poses[number];
      const Motion motion =
          closed_loop ? Motion{.tip = tip, .desired = clipped(line.first - tip, options.max_step)}
                      : Motion{.tip = line.first, .desired = line.second};
      StageTimes times;
      const Step step = constraint.step(motion, times);
      write_step(steps.stream(), number, motion, step, times);
      if (planes) write_planes(planes->stream(), number, step);
      tip += step.motion;
      ++counts[name(step.status)];
    }
  }
  steps.finish();
  if (planes) planes->finish();
  steps.commit();
  if (planes) planes->commit();

  out << counted(poses.size(), "step") << " -> " << options.steps.string() << '\n';
  for (const auto& [status, count] : counts) out << "  " << status << ": " << count << '\n';
}

}  // namespace keepout::app
