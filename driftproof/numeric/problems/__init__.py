"""Problems to integrate: stiff, nonlinear, extreme, each with a reference solution and the evidence for its digits."""
