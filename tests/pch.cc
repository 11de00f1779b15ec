// SPDX-License-Identifier: Apache-2.0
// Exists so that every test can share one precompiled gtest header.
