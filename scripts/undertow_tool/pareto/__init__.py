"""undertow pareto: error against cost over modelling choices of one case."""
