// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "options.h"
#include "workers.h"

namespace keepout::python {

/// A constraint as Python holds it: one for single steps, and one for each worker of a batch. All
/// share meshes and indices. Batches do not affect the single steps.
template <class Constraint, class Settings>
class GuardOf {
 public:
  virtual ~GuardOf() = default;

  // The methods of the Python class: see bind_guard.
  void forget() {
    const InUse in_use(constraint_in_use_);
    constraint_.forget();
  }

  void set_guides(const py::object& given) {
    const std::vector<Guide> guides = guides_from(given);
    const InUse no_batch(workers_.in_use());
    const InUse no_step(constraint_in_use_);
    constraint_.set_guides(guides);  // throws for guides out of range
    for (Constraint& worker : workers_.constraints()) worker.set_guides(guides);
    guides_ = guides;
  }

  void set_options(const py::kwargs& given) {
    auto options = settings_.options;
    std::vector<std::string_view> known;
    for (const auto& option : table_of(options)) known.push_back(option.name);
    require_known("set_options", given, known);
    take_given(table_of(options), given, options);
    const InUse no_batch(workers_.in_use());
    const InUse no_step(constraint_in_use_);
    constraint_.set_options(options);  // throws for options out of range
    workers_.constraints().clear();
    settings_.options = options;
  }

  /// Returns a constraint like this one, with all meshes and guides, for a loop of its own.
  Constraint another() const {
    Constraint made = made_anew();
    made.set_guides(guides_);
    return made;
  }
  const std::vector<Guide>& guides() const noexcept { return guides_; }

  /// Returns the index of the first mesh.
  const std::shared_ptr<IndexHandle>& index() const noexcept { return meshes_.front().index; }
  const Settings& settings() const noexcept { return settings_; }

 protected:
  /// A mesh and its own margin, or 0 for that of the guard.
  struct KeptMesh {
    std::shared_ptr<IndexHandle> index;
    double margin;
  };

  /// `make()` makes the constraint for single steps. It runs without Python's lock.
  template <class Make>
  GuardOf(std::shared_ptr<IndexHandle> index, Settings settings, const Make& make)
      : meshes_{{std::move(index), 0.0}}, settings_(std::move(settings)), constraint_([&] {
          const py::gil_scoped_release release;
          return make(meshes_.front().index, settings_);
        }()) {}

  /// Makes a constraint for a worker, with all meshes but without guides. Runs without Python's
  /// lock.
  virtual Constraint made_anew() const = 0;

  /// See Workers.
  template <class Item>
  void do_each(std::size_t items, std::size_t chunk, unsigned threads, const Item& item) {
    workers_.do_each(
        items, chunk, threads, [this] { return another(); }, item);
  }

  /// Replaces a mesh by that of an index; `follow()` makes the constraint follow it.
  template <class Follow>
  void replace_mesh(std::size_t mesh, std::shared_ptr<IndexHandle> index, const Follow& follow) {
    if (!index) refuse("index", "a keepout.Index", "None");
    const InUse no_batch(workers_.in_use());
    const InUse no_step(constraint_in_use_);
    {
      const py::gil_scoped_release release;
      follow();
      workers_.constraints().clear();
    }
    meshes_[mesh].index = std::move(index);
  }

  std::vector<KeptMesh> meshes_;
  Settings settings_;
  std::vector<Guide> guides_;
  Constraint constraint_;
  std::mutex constraint_in_use_;
  Workers<Constraint> workers_;
};

/// Returns the docstring of a class: the summary, and a line for each option.
template <class Settings>
std::string documented(const char* summary) {
  std::string text = summary;
  const Settings usual;
  for_each_option(usual,
                  [&](const auto& option, const auto&) { text += '\n' + described(option); });
  return text;
}

/// Adds the members that both constraints have, and a property for each option. `signature`: of the
/// constructor, up to its options. `init`: the constructor and its other arguments.
template <class Settings, class Guard, class... Init>
void bind_guard(py::class_<Guard>& type, const std::string& name, const char* signature,
                Init&&... init) {
  type.def("forget", &Guard::forget,
           "Forgets the last step; the next position is classified again. For motions that do\n"
           "not continue each other.")
      .def("set_guides", &Guard::set_guides, py::arg("guides"),
           "Replaces the guides of all later steps and batches. Changes nothing if it raises\n"
           "Error.\n"
           "\n"
           "guides: a list of at most 16; each is a Guide or the text of one, such as\n"
           "'corridor=slab:0,0,50:1,0,0:1': see Guide.of_text.")
      .def_property_readonly(
          "mesh", [](const Guard& self) { return self.index()->mesh_object; },
          "The mesh; if there are several, the first.")
      .def_property_readonly(
          "index", [](const Guard& self) { return self.index(); },
          "The Index of the first mesh, which others may share.");
  const Settings usual;
  std::string keywords;
  for (const auto& option : table_of(usual.options)) {
    keywords += ", " + std::string(option.name) + ": " + type_of(option) + " | None = None";
  }
  py::options texts;
  texts.disable_function_signatures();  // the function signatures lack the options
  type.def(std::forward<Init>(init)..., (signature + keywords_of(usual) + ") -> None").c_str());
  type.def(
      "set_options", [](Guard& self, const py::kwargs& given) { self.set_options(given); },
      ("set_options(self: keepout." + name + ", *" + keywords +
       ") -> None\n\nChanges these options from the next step on. None leaves an option unchanged. "
       "Changes nothing\nif it raises Error. After the margin is raised, recovery restores it.")
          .c_str());
  for_each_option(usual, [&]<class Options>(const Option<Options>& option, const Options&) {
    const auto get = option.get;
    type.def_property_readonly(
        std::string(option.name).c_str(),
        [get](const Guard& self) { return get(part_of<Options>(self.settings())); },
        described(option).c_str());
  });
}

}  // namespace keepout::python
