// SPDX-License-Identifier: BSD-3-Clause
/** The module that emscripten makes: build/wasm/keepout.mjs. */
declare module "keepout-module" {
  const makeModule: import("./keepout.ts").ModuleFactory;
  export default makeModule;
}
