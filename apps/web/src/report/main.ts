// SPDX-License-Identifier: BSD-3-Clause
/** The reports that show no anatomy. */
import { showReport } from "./report_page.ts";

void showReport({});
