// SPDX-License-Identifier: BSD-3-Clause
/** The reports that show anatomy. */
import { showReport } from "./report_page.ts";

void showReport({});
