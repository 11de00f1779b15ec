# SPDX-License-Identifier: Apache-2.0
"""What a generator is to the drawing of cases, and what a hidden effect is to a generator."""
import dataclasses
import typing


@dataclasses.dataclass
class Effect:
    """One effect with everything drawn but its size; `act` belongs to the generator, which knows how to apply it."""
    name: str
    law: str  # which of the laws for that name
    act: typing.Callable
    describe: typing.Callable  # scale -> {parameter: (value, unit)}
    first_scale: float
    most_scale: float  # beyond it the effect is no longer physically plausible
    signature: typing.Optional[dict] = None  # only effects outside the list: how a good program would point at them
    by_chance: bool = False  # its size is incoherent_sigma
    least_scale: float = 0.0


class Model:
    """Of one kind. A generator adds

    `noise`, and `residual(effects)` (channels x samples, off the nominal model; None where the machine does not survive it),
    `regressors()` (samples x nominal parameters), `record(effects, rng)` -> (metadata, columns), `make_effect(name, rng)`,
    `make_outside(rng)`, `nominal_parameters()`. `effects` are pairs (effect, scale).
    """
    kind = unit = None
    causes = ()
    rivals = ()  # causes that a single effect is compared with

    def rival_residual(self, effect):
        return self.residual([(effect, effect.first_scale)])

    def departure(self):
        """Residual of the contract's nominal model, on the clean record; None: there is none."""
        return None


def pick(rng, *laws):
    return str(rng.choice(laws))
