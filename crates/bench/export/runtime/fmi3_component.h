/* An instance and whom it tells, for FMI 3.0. */
#ifndef DYNOID_FMI3_COMPONENT_H
#define DYNOID_FMI3_COMPONENT_H

#include "fmi3.h"
#include "interface.h"

typedef struct {
    instance *bench;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} fmi3_component;

/* NULL for NULL. */
instance *fmi3_instance(fmi3Instance c);

#endif
