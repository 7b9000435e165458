    plant.T_e = flange.tau;
    der(flange.phi) = plant.w_e;
    w_d = plant.w_d;
    T_d = plant.T_d;
    T_shaft = plant.T_shaft;
    valid = plant.valid;