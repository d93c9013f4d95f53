"""Steps of methods in floats: the engine and its loops, implicit stages, multistep methods, controlled step sizes."""
