"""Problems to integrate: stiff, nonlinear, extreme, each with a reference solution whose digits are accounted for."""
