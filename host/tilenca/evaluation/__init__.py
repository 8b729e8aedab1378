"""What a model is asked and how well it answers: test suites, metrics, the model card."""
