# SPDX-License-Identifier: BSD-3-Clause
#
# Tests that dependencies point one way, and that public headers include only our headers, Eigen and the standard
# library.
# Run as: cmake -D SOURCE=... -P layering_test.cmake
cmake_minimum_required(VERSION 3.25)

# Fails for each line of a folder's files that matches the expression.
function(forbid folder expression why)
  set_property(GLOBAL APPEND PROPERTY folders_with_rules ${folder})
  file(GLOB_RECURSE files "${SOURCE}/${folder}/*.h" "${SOURCE}/${folder}/*.cpp")
  list(LENGTH files count)
  if(count EQUAL 0)
    message(SEND_ERROR "${folder} has no files: has it moved?")
  endif()
  foreach(file IN LISTS files)
    file(STRINGS "${file}" lines REGEX "${expression}")
    foreach(line IN LISTS lines)
      message(SEND_ERROR "${file}: ${line}\n  ${why}")
    endforeach()
  endforeach()
endfunction()

set(include "^ *# *include *[<\"]")
forbid(engine "${include}keepout/(adapters|solvers|factory|fixtures|control|robot)/" "the engine knows no other part")
foreach(part bullet ccd cgal embree fcl include src)
  forbid(adapters/${part} "${include}keepout/(solvers|factory|fixtures|control|robot|urdf)/" "adapters know only the engine")
endforeach()
forbid(solvers "${include}keepout/(adapters|factory|fixtures|control|robot)/" "solvers know only the engine")
forbid(fixtures "${include}keepout/(adapters|solvers|factory|control|urdf)/" "fixtures know only the engine and robots")
forbid(testing "${include}keepout/(factory|control|robot)/" "contracts know indices, solvers and generated input")
forbid(control "${include}keepout/(adapters|solvers|factory|fixtures)/" "control knows only the engine and robots")
forbid(robot "${include}keepout/(adapters|solvers|factory|fixtures|control)/" "robot knows only the engine")

# Each library has its own folder. Code that several of them share is in adapters/src.
set(libraries bullet ccd cgal embree fcl ompl urdf)
foreach(library IN LISTS libraries)
  set(others ${libraries})
  list(REMOVE_ITEM others ${library})
  list(JOIN others "|" others)
  forbid(adapters/${library} "${include}([^\"]*/)?\\.\\./([^\"]*/)?(${others})/"
         "one library's adapter knows no other's")
endforeach()

# Planning is its own library, which depends on the engine, robots and OMPL only.
forbid(adapters/ompl "${include}keepout/(adapters|solvers|factory|fixtures|control|urdf)/" "planning knows only the engine and robots")
forbid(engine "${include}(ompl/|keepout/ompl/)" "the engine knows no planner")
forbid(solvers "${include}(ompl/|keepout/ompl/)" "solvers know no planner")
forbid(factory "${include}(ompl/|keepout/ompl/)" "the factory knows no planner")
forbid(robot "${include}(ompl/|keepout/ompl/)" "robots know no planner")
forbid(adapters/src "${include}(ompl/|keepout/ompl/)" "the other adapters know no planner")

# The URDF reader is an optional library of its own, above robot.
forbid(adapters/urdf "${include}keepout/(adapters|solvers|factory|fixtures|control|ompl)/" "the reader knows only the engine and robots")
foreach(part engine solvers control robot factory)
  forbid(${part} "${include}(urdf_[a-z]+/|tinyxml|keepout/urdf/)" "the library reads no description of robots")
endforeach()

# Code that includes headers under the GPL stays in its own folder, a module.
foreach(part engine solvers control robot factory fixtures oracle adapters/include adapters/src
        adapters/bullet adapters/ccd adapters/embree adapters/fcl adapters/ompl adapters/urdf)
  forbid(${part} "${include}CGAL/"
         "the library is not to depend on the GPL")
endforeach()

# The oracle uses the data types of the engine, but none of its geometry. Judges also use steps, as data.
forbid(oracle "${include}keepout/(adapters|solvers|factory)/" "the oracle knows no other part")
forbid(oracle "${include}keepout/(index|activation)/" "the oracle shares no algorithm with the engine")
forbid(oracle "${include}keepout/geometry/(closest_point|orientation)" "the oracle has a geometry of its own")
foreach(part include src)
  forbid(oracle/${part} "${include}keepout/(fixtures|judges|robot|step)/" "the oracle knows no other part")
endforeach()
forbid(oracle/judges "${include}keepout/(mesh/diagnostics|step/(motion_|[^mo])|robot/([^i]|instrument(\\.|_[^os])))"
       "a judge takes motions, steps and options, and computes by the oracle alone")
# The monitor shares no computation with the steps: it knows their data types and interfaces alone.
forbid(monitor "${include}keepout/(adapters|activation|factory|fixtures|index|judges|oracle|solvers)/"
       "the monitor knows no other part")
forbid(monitor "${include}keepout/geometry/(closest_point|orientation)" "the monitor has a geometry of its own")
forbid(monitor "${include}keepout/(step/[^ot]|step/tip_[^m]|robot/(instrument_[^m]|[^i]))" "the monitor runs no step")
forbid(python "${include}keepout/(fixtures|judges|oracle)/" "the module is the library, and no more")
foreach(part engine adapters solvers control robot factory fixtures)
  forbid(${part} "${include}(pybind11/|Python.h)" "the library knows no Python")
endforeach()
foreach(part engine adapters solvers control robot factory fixtures testing)
  forbid(${part} "${include}keepout/(judges|oracle)/" "the oracle is for tests and the command")
endforeach()

# Public headers include only our headers, Eigen's, and the standard library's, whose names have no dot or slash.
foreach(part engine adapters adapters/ompl adapters/urdf solvers control robot monitor factory fixtures oracle oracle/judges)
  file(GLOB_RECURSE headers "${SOURCE}/${part}/include/*.h")
  foreach(header IN LISTS headers)
    file(STRINGS "${header}" lines REGEX "${include}")
    foreach(line IN LISTS lines)
      if(NOT line MATCHES "include (\"keepout/|<Eigen/|<[a-z_]+>)")
        message(SEND_ERROR "${header}: ${line}\n  a third-party header in a public one")
      endif()
    endforeach()
  endforeach()
endforeach()

# The layers of the engine, from the bottom: geometry, mesh, index, activation, step.
set(below "${include}(keepout/|(\\.\\./)+)")
foreach(kind include/keepout src)
  forbid(engine/${kind}/geometry "${below}(mesh|index|activation|step)/" "geometry is the ground")
  forbid(engine/${kind}/mesh "${below}(index|activation|step)/" "a mesh knows no index")
  forbid(engine/${kind}/index "${below}(activation|step)/" "an index knows no rule")
  forbid(engine/${kind}/activation "${below}step/" "a rule knows no step")
endforeach()

# In the index, the two trees use their common parts, but not each other.
forbid(engine/src/index/tree_parts "${include}(\\.\\./(pd_tree|wide_bvh)/|keepout/index/(pd_tree|wide_bvh))" "common parts know no tree")
forbid(engine/src/index/pd_tree "${include}(\\.\\./wide_bvh/|keepout/index/wide_bvh)" "one tree knows no other")
forbid(engine/src/index/wide_bvh "${include}(\\.\\./)+pd_tree/|${include}keepout/index/pd_tree" "one tree knows no other")

# In the command, main and its smaller commands may include every folder. A folder may include only the folders listed
# here.
set(folders igtl live operators page record serve shared simulate verify)
set(known_to_shared)
set(known_to_page shared)
set(known_to_record shared page)
set(known_to_serve shared)
set(known_to_operators shared simulate verify)  # for audits and scenes
set(known_to_verify operators shared record)
set(known_to_igtl shared)
set(known_to_live shared page verify)
set(known_to_simulate operators shared record verify)
foreach(folder IN LISTS folders)
  set(others ${folders})
  list(REMOVE_ITEM others ${folder} ${known_to_${folder}})
  list(JOIN others "|" others)
  forbid(apps/keepout/${folder} "${include}\"(commands\\.h|\\.\\./|(${others}|bench|compare|plan)/)" "of the command, ${folder} knows only: ${known_to_${folder}}")
endforeach()

# Comparisons may include the command, but the command includes no comparison.
set(known_to_bench compare simulate)
set(known_to_compare)
set(known_to_plan operators verify)
foreach(folder bench compare plan)
  set(others bench compare plan live operators serve simulate verify)
  list(REMOVE_ITEM others ${folder} ${known_to_${folder}})
  list(JOIN others "|" others)
  forbid(benchmarks/${folder} "${include}\"(commands\\.h|\\.\\./|(${others})/)" "of what compares, ${folder} knows only: ${known_to_${folder}}")
endforeach()

# A page uses the library and the mesh diagnostics, but no study.
forbid(apps/web "${include}\"(bench|compare|live|operators|plan|record|serve|simulate|verify)/" "a page knows no study")
forbid(apps/web "${include}keepout/(judges|oracle)/" "the oracle is for tests and the command")

# A node uses the library and the names of meshes; its transports use nothing of keepout.
forbid(apps/crtk_node "${include}(\"(commands\\.h|\\.\\./|(live|operators|page|record|serve|simulate|verify)/)|keepout/(judges|oracle)/)" "a node knows only shared parts of the command")
foreach(transport ros1 dds)
  forbid(apps/crtk_node/${transport} "${include}[<\"](keepout/|settings|node|guard_node)" "a transport knows only transport.h")
endforeach()

# Tests, examples and comparisons are the top layer: no other part may depend on them.
forbid(examples "${include}(keepout/(fixtures|judges|oracle)/|\"\\.\\./)" "an example is a program of a user")
forbid(benchmarks/native "${include}\"(\\.\\./|shared/|bench/|verify/)" "experiments know the libraries, and not the command")
forbid(benchmarks/python "${include}keepout/(fixtures|judges|oracle)/" "the loop that Python is held to is the library's")

# Every folder with sources has a rule, except tests and docs, which may include everything.
get_property(ruled GLOBAL PROPERTY folders_with_rules)
foreach(parent "" apps/ apps/keepout/ adapters/ benchmarks/)
  file(GLOB entries RELATIVE "${SOURCE}" "${SOURCE}/${parent}*")
  foreach(entry IN LISTS entries)
    if(NOT IS_DIRECTORY "${SOURCE}/${entry}" OR entry MATCHES "^(build|docs|tests|adapters|apps|apps/keepout|benchmarks)$" OR entry IN_LIST ruled)
      continue()
    endif()
    file(GLOB_RECURSE sources "${SOURCE}/${entry}/*.h" "${SOURCE}/${entry}/*.cpp")
    if(sources)
      message(SEND_ERROR "${entry} has sources, and no rule here says what it may include")
    endif()
  endforeach()
endforeach()
