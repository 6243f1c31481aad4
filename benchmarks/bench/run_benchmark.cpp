// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <ostream>
#include <utility>

#include "bench/bench.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "keepout/fixtures/motions.h"
#include "keepout/index/pd_tree.h"
#include "keepout/solvers/registry.h"
#include "shared/machine.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/progress.h"

namespace keepout::app {
namespace {

constexpr const char* reference_index = "wide_bvh";
constexpr const char* reference_solver = "active_set";
constexpr const char* certified_rule = "certified";
constexpr const char* usual_index = "fcl_obbrss";
constexpr const char* usual_solver = "nlopt_slsqp";

using Names = std::vector<std::string>;
using Radii = std::vector<double>;

/// Appends every combination of these parts that this build has, each once.
void add(std::vector<Combination>& all, const Names& index_names, const Names& rules,
         const Names& solvers, const Radii& radii) {
  const std::vector<std::optional<double>> any(radii.begin(), radii.end()), none(1);
  for (const std::string& index : index_names) {
    for (const std::string& rule : rules) {
      for (const std::string& solver : solvers) {
        if (!index_backends().has(index) || !activation_rules().has(rule) ||
            !solver_backends().has(solver)) {
          continue;
        }
        for (const std::optional<double>& radius : rule == certified_rule ? none : any) {
          const Combination combination{index, rule, solver, radius};
          if (std::ranges::find(all, combination) == all.end()) all.push_back(combination);
        }
      }
    }
  }
}

Names or_else(const Names& asked, const Names& otherwise) {
  return asked.empty() ? otherwise : asked;
}

/// Capacity for every step that is timed.
constexpr Capacity bench_capacity{
    .triangles = std::size_t{1} << 18, .planes = std::size_t{1} << 16, .variables = 3};

constexpr double margin = 0.2;  // of the certified rule, and from the tip to the surface [mm]

/// The memory of an index, by its name, as measured on another mesh. [bytes per triangle]
using MemoryTaken = std::map<std::string, double>;

/// One mesh, and the same motions for every combination.
class Trial {
 public:
  /// All arguments but `subject` must outlive this; build() adds to `memory`. Throws Error if the
  /// mesh does not exist.
  Trial(const Subject& subject, const BenchmarkPlan& plan, MemoryTaken& memory,
        const StopSignal& stop)
      : subject_(subject),
        plan_(plan),
        memory_(memory),
        stop_(stop),
        loaded_(load(subject)),
        reference_index_(std::make_shared<const PdTree>(loaded_.mesh)) {
    Random random(plan.seed);
    const MotionKind kind{.clearance = margin};
    motions_ = naming(subject, [&] {
      return plan.poses == Poses::contact
                 ? contact_motions(*loaded_.mesh, *reference_index_, plan.queries, kind, random)
                 : unrelated_motions(*loaded_.mesh, plan.queries, kind, random);
    });
  }

  /// Returns the mesh, and the time to read its file.
  const LoadedSubject& loaded() const noexcept { return loaded_; }

  /// Builds the index unless the last combination had the same. After a stop the row is unusable.
  BenchmarkRow measure(const Combination& combination) {
    if (row_["index"] != combination.index) build(combination.index);
    BenchmarkRow row = row_;
    if (combination.radius) row["radius"] = *combination.radius;
    row["activation"] = combination.activation;
    row["solver"] = combination.solver;
    if (!index_) return row;

    // The certified rule searches as far as the motion goes; the paper's rule takes the tip as it
    // is.
    MotionConstraintSettings settings{
        .activation = combination.activation,
        .options = {.radius = combination.radius.value_or(5.0),
                    .margin = combination.activation == certified_rule ? margin : 0.0},
        .inside = Inside::taken_as_is,
        .capacity = bench_capacity};
    Reference& expected = references_
                              .try_emplace({settings.activation, settings.options.radius},
                                           reference_index_, loaded_.mesh, settings, motions_)
                              .first->second;
    if (!expected.fits()) {
      row["remark"] = "not timed: more than " + grouped(expected.candidates.capacity()) +
                      " triangles are in reach; ask for a smaller radius";
      return row;
    }
    const double accuracy = combination.solver == settings.solver
                                ? 0.0
                                : solver_backends().named(combination.solver).accuracy;
    settings.solver = combination.solver;
    MotionConstraint constraint = make_motion_constraint(loaded_.mesh, index_, settings);
    app::measure(constraint, accuracy, motions_, expected, plan_.seconds, stop_, row);
    return row;
  }

 private:
  void build(const std::string& index) {
    index_.reset();  // two large indices may not fit in memory
    const std::size_t triangles = loaded_.mesh->triangle_count();
    row_ = new_row();
    row_.update({{"mesh", label_of(subject_)},
                 {"triangles", triangles},
                 {"vertices", loaded_.mesh->vertex_count()},
                 {"load_s", loaded_.seconds},
                 {"load_cores", loaded_.cores},
                 {"index", index}});
    const auto count = static_cast<double>(triangles);
    constexpr double while_building = 1.5;  // some use more memory while they build
    if (const auto taken = memory_.find(index); taken != memory_.end()) {
      const double needed = while_building * taken->second * count;
      const auto available = static_cast<double>(available_memory());
      if (needed > available) {
        row_["remark"] = "not built: needs up to " + rounded(1e-9 * needed, 2) + " GB, and " +
                         rounded(1e-9 * available, 2) + " GB are free";
        return;
      }
    }
    try {
      const IndexBackend& backend = index_backends().named(index);
      const UsedCores used;
      index_ = backend.make(loaded_.mesh);
      row_["build_s"] = used.seconds();
      row_["build_cores"] = used.own();
      memory_[index] = static_cast<double>(index_->memory()) / count;
      row_["bytes_per_triangle"] = memory_[index];
    } catch (const Error& error) {
      row_["remark"] = std::string("not built: ") + error.what();
    } catch (const std::bad_alloc&) {
      row_["remark"] = "not built: out of memory";
    }
  }

  Subject subject_;
  const BenchmarkPlan& plan_;
  MemoryTaken& memory_;
  const StopSignal& stop_;
  LoadedSubject loaded_;
  std::vector<Motion> motions_;
  std::shared_ptr<const SpatialIndex> reference_index_;
  std::map<std::pair<std::string, double>, Reference> references_;  // of each rule and radius
  std::shared_ptr<const SpatialIndex> index_;                       // null: not built
  BenchmarkRow row_ = new_row();  // the members that all combinations with this index share
};

void run_trial(const Subject& subject, const BenchmarkPlan& plan, MemoryTaken& memory,
               const StopSignal& stop, Benchmark& benchmark, std::ostream& out) {
  Progress progress("bench " + title_of(subject), plan.combinations.size());
  Trial trial(subject, plan, memory, stop);
  const LoadedSubject& loaded = trial.loaded();
  progress.interrupt();
  out << '\n'
      << label_of(subject) << ", " << counted(loaded.mesh->triangle_count(), "triangle") << ", "
      << grouped(loaded.mesh->vertex_count()) << " vertices; its file was read in "
      << rounded(loaded.seconds, 2) << " s with " << rounded(loaded.cores, 2) << " cores busy\n";
  print_table_head(out);
  for (const Combination& combination : plan.combinations) {
    progress.show(combination.index + " " + combination.activation + " " + combination.solver);
    BenchmarkRow row = naming(subject, [&] { return trial.measure(combination); });
    progress.interrupt();
    if (stop.has_come()) return;
    print_table_row(out, row);
    out.flush();
    benchmark.rows.push_back(std::move(row));
    progress.advance();
  }
}

/// Returns an empty record of this machine and of the parts that are measured.
Benchmark new_benchmark(const BenchmarkPlan& plan) {
  Benchmark benchmark{.date = date_now(),
                      .command = plan.command,
                      .seed = plan.seed,
                      .machine = this_machine(),
                      .planned = plan.combinations.size() * plan.subjects.size()};
  const auto describe = [&](const auto& table, std::string Combination::*part) {
    for (const auto& entry : table) {
      if (std::ranges::find(plan.combinations, entry.name, part) == plan.combinations.end()) {
        continue;
      }
      benchmark.parts.emplace(entry.name, entry.description);
      if constexpr (requires { entry.remark; }) {
        if (!entry.remark.empty()) benchmark.remarks.emplace(entry.name, entry.remark);
      }
    }
  };
  describe(index_backends(), &Combination::index);
  describe(activation_rules(), &Combination::activation);
  describe(solver_backends(), &Combination::solver);
  return benchmark;
}

}  // namespace

bool names_parts(const Selection& selection) {
  return !(selection.indices.empty() && selection.activations.empty() && selection.solvers.empty());
}

std::vector<Combination> combinations_of(const Selection& selection) {
  const Radii radii = selection.radii.empty() ? Radii{5.0, 1.0, 0.25} : selection.radii;
  std::vector<Combination> all;
  if (names_parts(selection)) {
    add(all, or_else(selection.indices, {reference_index}),
        or_else(selection.activations, {"paper", certified_rule}),
        or_else(selection.solvers, {reference_solver}), radii);
  } else {
    Names fast_indices = index_names();
    std::erase(fast_indices, "brute_force");  // takes a thousand times as long
    add(all, fast_indices, {"paper", certified_rule}, {reference_solver}, radii);
    add(all, {reference_index}, {"all_faces"}, {reference_solver}, radii);
    add(all, {reference_index}, {"paper", certified_rule}, solver_names(), radii);
    add(all, {usual_index}, {"paper"}, {usual_solver}, radii);
  }
  // By index, in the order of the table.
  std::ranges::stable_sort(all, {}, [](const Combination& combination) {
    const auto& table = index_backends();
    return std::ranges::find(table, combination.index, &IndexBackend::name) - table.begin();
  });
  return all;
}

void run_benchmark(const BenchmarkPlan& plan, const StopSignal& stop, Benchmark& benchmark,
                   std::ostream& out) {
  benchmark = new_benchmark(plan);
  const UsedCores used;
  print_machine(out, benchmark.machine);
  out.flush();
  // Also if a mesh is broken.
  const std::shared_ptr<void> at_the_end(nullptr,
                                         [&](void*) { benchmark.others_cores = used.others(); });
  MemoryTaken memory;
  for (const Subject& subject : plan.subjects) {
    if (stop.has_come()) return;
    run_trial(subject, plan, memory, stop, benchmark, out);
  }
}

}  // namespace keepout::app
