"""Learn factors on k_c from outcomes and propose new or changed corrections."""
