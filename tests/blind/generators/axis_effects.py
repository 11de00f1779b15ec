# SPDX-License-Identifier: Apache-2.0
"""What may hide in a simulated axis, by several laws for each name. `axis_model` is the AxisModel that asks."""
import math

from .axis import Coupling, Hidden
from .model import Effect, pick


def _term(name, law, shape, describe, first=0.03, most=0.5, signature=None, least=0.0):
    return Effect(name, law, lambda scale: Hidden(terms=(lambda *at: scale * shape(*at),)), describe, first, most, signature,
                  least_scale=least)


def make(axis_model, name, rng):
    m = axis_model
    top, span = m.top_speed, m.span
    sign = float(rng.choice([-1.0, 1.0]))
    nothing = lambda scale: {}
    amplitude = lambda scale: {"amplitude": (scale * span, "Nm")}
    if name == "stribeck_friction":
        law, fall = pick(rng, "lorentz", "difference_of_tanh", "inverse_root"), top * rng.uniform(0.04, 0.12)
        falls = {"lorentz": lambda v: 1.0 / (1.0 + (v / fall) ** 2),  # Hess 1990
                 "difference_of_tanh": lambda v: 1.0 - math.tanh(abs(v) / fall),  # Makkar 2005
                 "inverse_root": lambda v: 1.0 / math.sqrt(1.0 + (2.0 * v / fall) ** 2)}[law]
        return _term(name, law, lambda t, q, v, a, f: span * falls(v) * f, lambda scale: {"rise": (scale * span, "Nm")})
    if name == "asymmetric_friction":
        law = pick(rng, "root_of_speed", "square_of_speed", "one_side_levels_off")
        power = {"root_of_speed": 0.5, "square_of_speed": 2.0}.get(law)
        if power:
            return _term(name, law, lambda t, q, v, a, f: sign * span * abs(v / top) ** power, nothing)
        knee = rng.uniform(0.3, 0.6) * top
        return _term(name, law, lambda t, q, v, a, f: sign * span * (math.tanh(abs(v) / knee) if sign * v > 0.0 else 0.0), nothing)
    if name == "position_periodic_torque":
        return _ripple(m, rng)
    if name == "gravity_load":
        law, phase = pick(rng, "arm", "arm_with_counterweight", "arm_of_two_links"), rng.uniform(-math.pi, math.pi)
        second = {"arm": 0.0, "arm_with_counterweight": 0.02, "arm_of_two_links": 0.04}[law]
        return _term(name, law, lambda t, q, v, a, f: span * (math.sin(q + phase) + second * math.sin(2.0 * (q + phase))), amplitude)
    if name == "quadratic_drag":
        law = pick(rng, "turbulent", "of_a_rough_wall", "with_a_laminar_start")
        power = {"turbulent": 1.85, "of_a_rough_wall": 2.0}.get(law)
        if power:
            return _term(name, law, lambda t, q, v, a, f: math.copysign(span * abs(v / top) ** power, v), nothing)
        soft = rng.uniform(0.05, 0.15) * top
        return _term(name, law, lambda t, q, v, a, f: span * v * (math.hypot(v, soft) - soft) / top ** 2, nothing)
    if name == "load_dependent_friction":
        law, most = pick(rng, "level_with_load", "preloaded_contact", "efficiency"), m.axis.inertia * m.top_acceleration
        base = rng.uniform(0.1, 0.3)
        loads = {"level_with_load": lambda load, v: abs(load),
                 "preloaded_contact": lambda load, v: math.hypot(load, base) - base,
                 # Driven by its load a gear loses less than when it drives.
                 "efficiency": lambda load, v: abs(load) * (1.0 if load * v > 0.0 else 0.7)}[law]
        return _term(name, law, lambda t, q, v, a, f: span * loads(m.axis.inertia * a / most, v) * f, nothing)
    if name == "thermal_friction_drift":
        law, part = pick(rng, "exponential_in_temperature", "bearing_and_grease", "two_time_constants"), rng.uniform(0.1, 0.7)
        course = m.thermal_course(law, rng)
        return _term(name, law, lambda t, q, v, a, f: -span * course(t) * ((1.0 - part) * f + part * v / top), nothing)
    if name == "torsional_resonance":
        return _resonance(m, rng)
    if name == "backlash":
        return _backlash(m, rng)
    if name == "time_delay":
        law = pick(rng, "dead_time", "one_lag", "two_lags")
        acts = {"dead_time": lambda scale: Hidden(late_s=scale), "one_lag": lambda scale: Hidden(lags_s=(scale,)),
                "two_lags": lambda scale: Hidden(lags_s=(0.5 * scale, 0.5 * scale))}
        return Effect(name, law, acts[law], lambda scale: {"delay": (scale, "s")} if law == "dead_time" else {}, 6e-4, 6e-3)
    return _disturbance(m, rng)


def _ripple(m, rng):
    reach, span = m.reach, m.span
    orders = [n for n in (3, 5, 6, 9, 11, 14, 18, 22, 28, 33, 42, 54, 72, 90, 120)
              if n * reach > 6.0 * math.pi and n * m.top_speed < 2.0 * math.pi * 0.1 * m.rate_hz]
    if not orders:
        return None
    order, phase = float(rng.choice(orders)), rng.uniform(-math.pi, math.pi)
    law, bend = pick(rng, "cogging_of_two_orders", "friction_by_angle", "slots_that_are_skewed"), rng.uniform(0.1, 0.25)
    shapes = {"cogging_of_two_orders": lambda q, f: math.sin(order * q + phase) + bend * math.sin(2.0 * order * q + 2.3 * phase),
              "friction_by_angle": lambda q, f: 1.2 * math.cos(order * q + phase) * f,
              "slots_that_are_skewed": lambda q, f: math.sin(order * q + phase + 1.5 * bend * math.sin(order * q + phase))}
    shape = shapes[law]
    return _term("position_periodic_torque", law, lambda t, q, v, a, f: span * shape(q, f),
                 lambda scale: {"order": (order, "1/rev")}, 0.02)


def _resonance(m, rng):
    hertz = min(m.highest_hz * rng.uniform(3.0, 7.0), 0.1 * m.rate_hz, 24.0)
    omega, damping = 2.0 * math.pi * hertz, rng.uniform(0.01, 0.05)
    law = pick(rng, "linear_spring", "hardening_spring", "friction_in_the_spring")
    bend = m.top_acceleration / omega ** 2  # of the spring at the largest acceleration
    spring = {"linear_spring": lambda lead, closing: lead,
              "hardening_spring": lambda lead, closing: lead * (1.0 + 0.15 * (lead / bend) ** 2),
              "friction_in_the_spring": lambda lead, closing: lead + 0.03 * abs(lead) * math.tanh(closing / (0.05 * bend * omega))}[law]
    return Effect("torsional_resonance", law, lambda scale: Hidden(coupling=Coupling(
        scale, lambda lead, closing: omega ** 2 * spring(lead, closing) + 2.0 * damping * omega * closing)),
        lambda scale: {"frequency": (hertz, "Hz")} if law == "linear_spring" else {}, 0.1, 0.6)


def _backlash(m, rng):
    law, share = pick(rng, "dead_zone", "soft_dead_zone", "impacts_that_lose_energy"), 10.0 ** rng.uniform(-1.0, -0.3)
    omega, damping = 2.0 * math.pi * rng.uniform(30.0, 45.0), rng.uniform(0.4, 0.7)
    friction_share = rng.uniform(0.1, 0.4) * share

    def contact(gap):
        half = 0.5 * gap

        def dead_zone(lead, closing):
            over = lead - half if lead > half else lead + half if lead < -half else 0.0
            push = omega ** 2 * over + 2.0 * damping * omega * closing if over else 0.0
            return push if push * over > 0.0 else 0.0

        def soft(lead, closing):  # teeth touch one after another
            width = 0.25 * half + 1e-9
            slope = 1.0 + 0.5 * (math.tanh((lead - half) / width) - math.tanh((lead + half) / width))
            over = lead + 0.5 * width * (_ln_cosh((lead - half) / width) - _ln_cosh((lead + half) / width))
            return omega ** 2 * over + 2.0 * damping * omega * closing * slope

        def hunt_crossley(lead, closing):  # the damping grows with the indentation (Hunt 1975)
            over = lead - half if lead > half else lead + half if lead < -half else 0.0
            factor = 1.0 + 2.0 * damping * omega * closing * math.copysign(1.0, over) / m.top_acceleration
            return omega ** 2 * over * min(max(factor, 0.0), 3.0)
        return {"dead_zone": dead_zone, "soft_dead_zone": soft, "impacts_that_lose_energy": hunt_crossley}[law]
    return Effect("backlash", law, lambda scale: Hidden(coupling=Coupling(share, contact(scale), friction_share)),
                  lambda scale: {"gap": (scale, "rad")}, 0.004 * m.reach, 0.06 * m.reach, least_scale=0.0005 * m.reach)


def _ln_cosh(x):
    return abs(x) + math.log1p(math.exp(-2.0 * abs(x))) - math.log(2.0)


def _disturbance(m, rng):
    law, span = pick(rng, "push_and_release", "drag_of_a_hand", "unsteady_load"), m.span
    length_s = rng.uniform(0.4, 1.6)
    start_s = rng.uniform(0.15 * m.duration_s, 0.9 * m.duration_s - length_s)
    sign, hertz, phase = float(rng.choice([-1.0, 1.0])), rng.uniform(3.0, 7.0), rng.uniform(0.0, 6.0)
    shapes = {"push_and_release": lambda x, f: sign * x ** 0.7 * min(1.0, 12.0 * (1.0 - x)),
              "drag_of_a_hand": lambda x, f: sign * math.sin(math.pi * x) ** 0.5 * (0.7 + 0.3 * f * sign),
              "unsteady_load": lambda x, f: sign * math.sin(math.pi * x) * (0.7 + 0.5 * math.sin(2.0 * math.pi * hertz * x * length_s + phase))}
    shape = shapes[law]

    def push(t, q, v, a, f):
        x = (t - start_s) / length_s
        return span * shape(x, f) if 0.0 < x < 1.0 else 0.0
    return _term("external_disturbance", law, push,
                 lambda scale: {"window_start": (start_s, "s"), "window_end": (start_s + length_s, "s")}, 0.05, 0.8)


def make_outside(m, rng):
    law, span, low, high = pick(rng, "bumper", "cable_with_a_hook", "hum_that_swells"), m.span, m.lowest, m.highest
    amplitude = lambda scale: {"peak": (scale * span, "Nm")}
    if law == "bumper":  # touched near one end of the way, a spring that gets stiffer
        side = float(rng.choice([-1.0, 1.0]))
        end, start = (high, high - rng.uniform(0.15, 0.3) * (high - low)) if side > 0.0 else (low, low + rng.uniform(0.15, 0.3) * (high - low))
        window = sorted((start, end))

        def bump(t, q, v, a, f):
            over = max((q - start) / (end - start), 0.0)
            return side * span * over * over
        return _term(law, law, bump, amplitude, signature={"what": "window", "regressor": "position", "window": window, "values": [],
                                                           "tolerance": 0.0, "unit": "rad"})
    if law == "cable_with_a_hook":  # takes hold over a narrow range of position, then lets go
        centre, half = low + (high - low) * rng.uniform(0.3, 0.7), (high - low) * rng.uniform(0.03, 0.07)

        def hook(t, q, v, a, f):
            x = (q - centre) / half
            return span * x * math.exp(0.5 * (1.0 - x * x)) if abs(x) < 4.0 else 0.0
        return _term(law, law, hook, amplitude, signature={"what": "window", "regressor": "position", "values": [], "tolerance": 0.0,
                                                           "window": [centre - 1.5 * half, centre + 1.5 * half], "unit": "rad"})
    hertz = rng.uniform(max(5.0 * m.highest_hz, 0.04 * m.rate_hz), 0.12 * m.rate_hz)
    swell_hz, phase = rng.uniform(1.5, 3.0) / m.duration_s, rng.uniform(0.0, 6.0)

    def hum(t, q, v, a, f):
        return span * (1.0 + 0.6 * math.sin(2.0 * math.pi * swell_hz * t)) * math.sin(2.0 * math.pi * hertz * t + phase)
    return _term(law, law, hum, amplitude, signature={"what": "order", "regressor": "time", "relative": True, "tolerance": 0.03,
                                                      "values": [hertz, 1.0 / hertz, 2.0 * math.pi * hertz]})
