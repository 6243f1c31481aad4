// SPDX-License-Identifier: BSD-3-Clause
// The module mujoco: the only source that includes MuJoCo.

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "psm_model.h"
#include "simulate/simulated_robot.h"

namespace keepout::app {
namespace {

constexpr double cycle = 1e-3;  // [s]
constexpr int settling = 200;   // [cycles]
constexpr double millimeter = 1e-3;

using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
using Data = std::unique_ptr<mjData, decltype(&mj_deleteData)>;

/// Returns the model of a text in MuJoCo's format. Throws std::runtime_error.
Model model_of(std::string_view text) {
  constexpr const char* name = "model.xml";
  const auto files = std::make_unique<mjVFS>();  // 2 MB
  mj_defaultVFS(files.get());
  if (mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(text.size())) != 0) {
    throw std::runtime_error("MuJoCo has no memory for the model of the robot");
  }
  std::memcpy(files->filedata[0], text.data(), text.size());
  char message[1000] = "";
  Model model(mj_loadXML(name, files.get(), message, sizeof message), &mj_deleteModel);
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo rejects the model: ") + message);
  return model;
}

class MujocoRobot final : public SimulatedRobot {
 public:
  MujocoRobot(std::string_view text, double gravity)
      : model_(model_of(text)), data_(mj_makeData(model_.get()), &mj_deleteData) {
    if (!data_) throw std::runtime_error("MuJoCo has no memory for the state of the robot");
    if (model_->nq != model_->njnt || model_->nu != model_->njnt) {
      throw std::runtime_error("each joint of the model must have one axis and one servo");
    }
    // Without this function, MuJoCo writes a file of warnings. follow() throws instead.
    mju_user_warning = [](const char*) {};
    model_->opt.gravity[2] = -gravity;
    for (int k = 0; k < model_->njnt; ++k) {
      unit_.push_back(model_->jnt_type[k] == mjJNT_SLIDE ? millimeter : 1.0);
      limits_.push_back(model_->actuator_forcerange[2 * k + 1]);
    }
    positions_.resize(unit_.size());
    efforts_.resize(unit_.size());
  }

  void start(std::span<const double> setpoint) override {
    mj_resetData(model_.get(), data_.get());
    for (std::size_t k = 0; k < unit_.size(); ++k) data_->qpos[k] = unit_[k] * setpoint[k];
    for (int i = 0; i < settling; ++i) follow(setpoint);
  }

  void follow(std::span<const double> setpoint) override {
    for (std::size_t k = 0; k < unit_.size(); ++k) data_->ctrl[k] = unit_[k] * setpoint[k];
    const int steps = static_cast<int>(std::lround(cycle / model_->opt.timestep));
    for (int i = 0; i < steps; ++i) mj_step(model_.get(), data_.get());
    for (const mjWarningStat& warning : data_->warning) {
      // After such a warning MuJoCo begins again at zero.
      if (warning.number > 0) throw std::runtime_error("the simulation of the robot diverges");
    }
    for (std::size_t k = 0; k < unit_.size(); ++k) {
      positions_[k] = data_->qpos[k] / unit_[k];
      efforts_[k] = data_->actuator_force[k];
    }
  }

  std::span<const double> positions() const override { return positions_; }
  std::span<const double> efforts() const override { return efforts_; }
  std::span<const double> effort_limits() const override { return limits_; }

 private:
  Model model_;
  Data data_;
  std::vector<double> unit_;  // of each joint, in SI units
  std::vector<double> positions_, efforts_, limits_;
};

}  // namespace
}  // namespace keepout::app

extern "C" [[gnu::visibility("default")]] const keepout::app::MakeSimulatedPsm simulated_psm;
extern "C" const keepout::app::MakeSimulatedPsm simulated_psm =
    [](double gravity) -> std::unique_ptr<keepout::app::SimulatedRobot> {
  return std::make_unique<keepout::app::MujocoRobot>(psm_model, gravity);
};
