/* What FMI 3.0 calls its types and functions, as far as an FMU gives them. */
#ifndef DYNOID_FMI3_H
#define DYNOID_FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "export.h"

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum { fmi3Independent, fmi3Constant, fmi3Fixed, fmi3Tunable, fmi3Discrete, fmi3Dependent } fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String category, fmi3String message);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64 time, fmi3Boolean, fmi3Boolean,
                                               fmi3Boolean, fmi3Boolean, fmi3Boolean *, fmi3Float64 *);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

/* Where sources are linked into one program, an importer gives each FMU a prefix of its own. */
#ifdef FMI3_FUNCTION_PREFIX
#define FMI3_JOIN(prefix, name) prefix##name
#define FMI3_EXPAND(prefix, name) FMI3_JOIN(prefix, name)
#define FMI3(name) FMI3_EXPAND(FMI3_FUNCTION_PREFIX, name)
#else
#define FMI3(name) name
#endif
#define FMI3_CALL DYNOID_EXPORT fmi3Status
#define FMI3_REFERENCES fmi3Instance, const fmi3ValueReference[], size_t

DYNOID_EXPORT const char *FMI3(fmi3GetVersion)(void);
FMI3_CALL FMI3(fmi3SetDebugLogging)(fmi3Instance, fmi3Boolean, size_t, const fmi3String[]);
DYNOID_EXPORT fmi3Instance FMI3(fmi3InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                                              fmi3Boolean visible, fmi3Boolean logging,
                                                              fmi3InstanceEnvironment, fmi3LogMessageCallback);
DYNOID_EXPORT fmi3Instance FMI3(fmi3InstantiateCoSimulation)(fmi3String name, fmi3String token, fmi3String resources,
                                                             fmi3Boolean visible, fmi3Boolean logging,
                                                             fmi3Boolean event_mode, fmi3Boolean early_return,
                                                             const fmi3ValueReference intermediate[], size_t intermediates,
                                                             fmi3InstanceEnvironment, fmi3LogMessageCallback,
                                                             fmi3IntermediateUpdateCallback);
DYNOID_EXPORT fmi3Instance FMI3(fmi3InstantiateScheduledExecution)(fmi3String name, fmi3String token,
                                                                   fmi3String resources, fmi3Boolean visible,
                                                                   fmi3Boolean logging, fmi3InstanceEnvironment,
                                                                   fmi3LogMessageCallback, fmi3ClockUpdateCallback,
                                                                   fmi3LockPreemptionCallback,
                                                                   fmi3UnlockPreemptionCallback);
DYNOID_EXPORT void FMI3(fmi3FreeInstance)(fmi3Instance);
FMI3_CALL FMI3(fmi3EnterInitializationMode)(fmi3Instance, fmi3Boolean, fmi3Float64 tolerance, fmi3Float64 start,
                                            fmi3Boolean, fmi3Float64 stop);
FMI3_CALL FMI3(fmi3ExitInitializationMode)(fmi3Instance);
FMI3_CALL FMI3(fmi3EnterEventMode)(fmi3Instance);
FMI3_CALL FMI3(fmi3Terminate)(fmi3Instance);
FMI3_CALL FMI3(fmi3Reset)(fmi3Instance);

FMI3_CALL FMI3(fmi3GetFloat32)(FMI3_REFERENCES, fmi3Float32[], size_t);
FMI3_CALL FMI3(fmi3GetFloat64)(FMI3_REFERENCES, fmi3Float64[], size_t);
FMI3_CALL FMI3(fmi3GetInt8)(FMI3_REFERENCES, fmi3Int8[], size_t);
FMI3_CALL FMI3(fmi3GetUInt8)(FMI3_REFERENCES, fmi3UInt8[], size_t);
FMI3_CALL FMI3(fmi3GetInt16)(FMI3_REFERENCES, fmi3Int16[], size_t);
FMI3_CALL FMI3(fmi3GetUInt16)(FMI3_REFERENCES, fmi3UInt16[], size_t);
FMI3_CALL FMI3(fmi3GetInt32)(FMI3_REFERENCES, fmi3Int32[], size_t);
FMI3_CALL FMI3(fmi3GetUInt32)(FMI3_REFERENCES, fmi3UInt32[], size_t);
FMI3_CALL FMI3(fmi3GetInt64)(FMI3_REFERENCES, fmi3Int64[], size_t);
FMI3_CALL FMI3(fmi3GetUInt64)(FMI3_REFERENCES, fmi3UInt64[], size_t);
FMI3_CALL FMI3(fmi3GetBoolean)(FMI3_REFERENCES, fmi3Boolean[], size_t);
FMI3_CALL FMI3(fmi3GetString)(FMI3_REFERENCES, fmi3String[], size_t);
FMI3_CALL FMI3(fmi3GetBinary)(FMI3_REFERENCES, size_t sizes[], fmi3Binary[], size_t);
FMI3_CALL FMI3(fmi3GetClock)(FMI3_REFERENCES, fmi3Clock[]);
FMI3_CALL FMI3(fmi3SetFloat32)(FMI3_REFERENCES, const fmi3Float32[], size_t);
FMI3_CALL FMI3(fmi3SetFloat64)(FMI3_REFERENCES, const fmi3Float64[], size_t);
FMI3_CALL FMI3(fmi3SetInt8)(FMI3_REFERENCES, const fmi3Int8[], size_t);
FMI3_CALL FMI3(fmi3SetUInt8)(FMI3_REFERENCES, const fmi3UInt8[], size_t);
FMI3_CALL FMI3(fmi3SetInt16)(FMI3_REFERENCES, const fmi3Int16[], size_t);
FMI3_CALL FMI3(fmi3SetUInt16)(FMI3_REFERENCES, const fmi3UInt16[], size_t);
FMI3_CALL FMI3(fmi3SetInt32)(FMI3_REFERENCES, const fmi3Int32[], size_t);
FMI3_CALL FMI3(fmi3SetUInt32)(FMI3_REFERENCES, const fmi3UInt32[], size_t);
FMI3_CALL FMI3(fmi3SetInt64)(FMI3_REFERENCES, const fmi3Int64[], size_t);
FMI3_CALL FMI3(fmi3SetUInt64)(FMI3_REFERENCES, const fmi3UInt64[], size_t);
FMI3_CALL FMI3(fmi3SetBoolean)(FMI3_REFERENCES, const fmi3Boolean[], size_t);
FMI3_CALL FMI3(fmi3SetString)(FMI3_REFERENCES, const fmi3String[], size_t);
FMI3_CALL FMI3(fmi3SetBinary)(FMI3_REFERENCES, const size_t sizes[], const fmi3Binary[], size_t);
FMI3_CALL FMI3(fmi3SetClock)(FMI3_REFERENCES, const fmi3Clock[]);

FMI3_CALL FMI3(fmi3GetNumberOfVariableDependencies)(fmi3Instance, fmi3ValueReference, size_t *);
FMI3_CALL FMI3(fmi3GetVariableDependencies)(fmi3Instance, fmi3ValueReference, size_t[], fmi3ValueReference[], size_t[],
                                            fmi3DependencyKind[], size_t);
FMI3_CALL FMI3(fmi3GetFMUState)(fmi3Instance, fmi3FMUState *);
FMI3_CALL FMI3(fmi3SetFMUState)(fmi3Instance, fmi3FMUState);
FMI3_CALL FMI3(fmi3FreeFMUState)(fmi3Instance, fmi3FMUState *);
FMI3_CALL FMI3(fmi3SerializedFMUStateSize)(fmi3Instance, fmi3FMUState, size_t *);
FMI3_CALL FMI3(fmi3SerializeFMUState)(fmi3Instance, fmi3FMUState, fmi3Byte[], size_t);
FMI3_CALL FMI3(fmi3DeserializeFMUState)(fmi3Instance, const fmi3Byte[], size_t, fmi3FMUState *);
FMI3_CALL FMI3(fmi3GetDirectionalDerivative)(fmi3Instance, const fmi3ValueReference[], size_t,
                                             const fmi3ValueReference[], size_t, const fmi3Float64[], size_t,
                                             fmi3Float64[], size_t);
FMI3_CALL FMI3(fmi3GetAdjointDerivative)(fmi3Instance, const fmi3ValueReference[], size_t, const fmi3ValueReference[],
                                         size_t, const fmi3Float64[], size_t, fmi3Float64[], size_t);
FMI3_CALL FMI3(fmi3EnterConfigurationMode)(fmi3Instance);
FMI3_CALL FMI3(fmi3ExitConfigurationMode)(fmi3Instance);
FMI3_CALL FMI3(fmi3GetIntervalDecimal)(FMI3_REFERENCES, fmi3Float64[], fmi3IntervalQualifier[]);
FMI3_CALL FMI3(fmi3GetIntervalFraction)(FMI3_REFERENCES, fmi3UInt64[], fmi3UInt64[], fmi3IntervalQualifier[]);
FMI3_CALL FMI3(fmi3GetShiftDecimal)(FMI3_REFERENCES, fmi3Float64[]);
FMI3_CALL FMI3(fmi3GetShiftFraction)(FMI3_REFERENCES, fmi3UInt64[], fmi3UInt64[]);
FMI3_CALL FMI3(fmi3SetIntervalDecimal)(FMI3_REFERENCES, const fmi3Float64[]);
FMI3_CALL FMI3(fmi3SetIntervalFraction)(FMI3_REFERENCES, const fmi3UInt64[], const fmi3UInt64[]);
FMI3_CALL FMI3(fmi3SetShiftDecimal)(FMI3_REFERENCES, const fmi3Float64[]);
FMI3_CALL FMI3(fmi3SetShiftFraction)(FMI3_REFERENCES, const fmi3UInt64[], const fmi3UInt64[]);
FMI3_CALL FMI3(fmi3EvaluateDiscreteStates)(fmi3Instance);
FMI3_CALL FMI3(fmi3UpdateDiscreteStates)(fmi3Instance, fmi3Boolean *, fmi3Boolean *, fmi3Boolean *, fmi3Boolean *,
                                         fmi3Boolean *, fmi3Float64 *);
/* Model Exchange */
FMI3_CALL FMI3(fmi3EnterContinuousTimeMode)(fmi3Instance);
FMI3_CALL FMI3(fmi3CompletedIntegratorStep)(fmi3Instance, fmi3Boolean, fmi3Boolean *, fmi3Boolean *);
FMI3_CALL FMI3(fmi3SetTime)(fmi3Instance, fmi3Float64);
FMI3_CALL FMI3(fmi3SetContinuousStates)(fmi3Instance, const fmi3Float64[], size_t);
FMI3_CALL FMI3(fmi3GetContinuousStateDerivatives)(fmi3Instance, fmi3Float64[], size_t);
FMI3_CALL FMI3(fmi3GetEventIndicators)(fmi3Instance, fmi3Float64[], size_t);
FMI3_CALL FMI3(fmi3GetContinuousStates)(fmi3Instance, fmi3Float64[], size_t);
FMI3_CALL FMI3(fmi3GetNominalsOfContinuousStates)(fmi3Instance, fmi3Float64[], size_t);
FMI3_CALL FMI3(fmi3GetNumberOfEventIndicators)(fmi3Instance, size_t *);
FMI3_CALL FMI3(fmi3GetNumberOfContinuousStates)(fmi3Instance, size_t *);
/* Co-Simulation */
FMI3_CALL FMI3(fmi3EnterStepMode)(fmi3Instance);
FMI3_CALL FMI3(fmi3GetOutputDerivatives)(FMI3_REFERENCES, const fmi3Int32[], fmi3Float64[], size_t);
FMI3_CALL FMI3(fmi3DoStep)(fmi3Instance, fmi3Float64 from, fmi3Float64 length, fmi3Boolean, fmi3Boolean *, fmi3Boolean *,
                           fmi3Boolean *, fmi3Float64 *);
/* Scheduled Execution */
FMI3_CALL FMI3(fmi3ActivateModelPartition)(fmi3Instance, fmi3ValueReference, fmi3Float64);

#endif
