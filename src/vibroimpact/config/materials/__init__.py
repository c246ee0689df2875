"""Properties of named solids and fluids against temperature."""
