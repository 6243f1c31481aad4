// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/testing/trials.h"
