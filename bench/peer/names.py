"""The peers, their names in tables and figures."""

# In the order of tables; key -> (name, how it searches).
PEERS = {
    "numpy-slsqp": ("NumPy, SLSQP", "random starts, SciPy's forward differences"),
    "numpy-slsqp-batched": (
        "NumPy, SLSQP, batched differences",
        "random starts, all 36 differences in one NumPy call",
    ),
    "pinocchio-slsqp": (
        "Pinocchio, SLSQP",
        "random starts, Pinocchio's Jacobians, SciPy's forward differences",
    ),
    "jax-lbfgsb": ("JAX, L-BFGS-B", "random starts, gradient of the index as it is"),
    "jax-lbfgsb-smoothed": (
        "JAX, L-BFGS-B, log-sum-exp",
        "random starts, smoothed maxima, sharper in three stages",
    ),
    "jax-slsqp-epigraph": (
        "JAX, SLSQP, epigraph",
        "random starts, k(J_N) as constraints of an epigraph variable",
    ),
    "differential-evolution": (
        "Differential evolution",
        "populations of 540, one call per generation, polished at 90 % of the time",
    ),
    "dual-annealing": ("Dual annealing", "local search by L-BFGS-B with JAX's gradients"),
}


def peer_name(key):
    """Name of a peer in tables and figures."""
    return PEERS[key][0]
