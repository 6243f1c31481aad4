// SPDX-License-Identifier: BSD-3-Clause
/** What emscripten makes: build/wasm/keepout.mjs. */
declare module "keepout-module" {
  const makeModule: import("./keepout.ts").ModuleFactory;
  export default makeModule;
}

/** The same with whole instruments: build/wasm/keepout_robot.mjs. */
declare module "keepout-robot-module" {
  const makeModule: import("./keepout.ts").ModuleFactory<import("./manipulator.ts").RobotModule>;
  export default makeModule;
}
