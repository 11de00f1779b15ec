# SPDX-License-Identifier: Apache-2.0
"""Forward models beside those of the folder above, by other laws, integrators, controllers and noise. First read: registry.py."""
