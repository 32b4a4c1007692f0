"""Speed against goals and against other libraries; what needs no graph is measured by `evaluation.benchmark_*`."""
