// SPDX-License-Identifier: Apache-2.0
// Exists so that the libraries can share precompiled headers.
