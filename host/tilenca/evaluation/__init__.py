"""The evaluation of a model: test suites, metrics, the model card."""
