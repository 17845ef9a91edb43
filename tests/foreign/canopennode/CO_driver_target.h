/* CANopenNode on a bus that is called, not polled: frames come in by node_receive, go out by a
 * function of the caller. Names and meaning of everything here are prescribed by CO_driver.h. */
#ifndef CO_DRIVER_TARGET_H
#define CO_DRIVER_TARGET_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CO_CONFIG_STORAGE 0
#define CO_CONFIG_LEDS 0
#define CO_CONFIG_LSS 0
#define CO_CONFIG_TIME 0
#define CO_CONFIG_GTW 0
#define CO_CONFIG_SDO_CLI 0
#define CO_CONFIG_NODE_GUARDING 0
/* CO_CONFIG_EM_PRODUCER, _PROD_CONFIGURABLE, _PROD_INHIBIT, _HISTORY */
#define CO_CONFIG_EM (0x01 | 0x02 | 0x04 | 0x08)

#define CO_LITTLE_ENDIAN
#define CO_SWAP_16(x) x
#define CO_SWAP_32(x) x
#define CO_SWAP_64(x) x
typedef uint_fast8_t bool_t;
typedef float float32_t;
typedef double float64_t;

typedef struct {
    uint16_t ident;
    uint8_t dlc;
    uint8_t data[8];
} node_frame_t;

#define CO_CANrxMsg_readIdent(msg) (((const node_frame_t *)(msg))->ident)
#define CO_CANrxMsg_readDLC(msg) (((const node_frame_t *)(msg))->dlc)
#define CO_CANrxMsg_readData(msg) (((const node_frame_t *)(msg))->data)

typedef struct {
    uint16_t ident, mask;
    void *object;
    void (*CANrx_callback)(void *object, void *message);
} CO_CANrx_t;

typedef struct {
    uint32_t ident;
    uint8_t DLC;
    uint8_t data[8];
    volatile bool_t bufferFull, syncFlag;
} CO_CANtx_t;

typedef struct {
    void *CANptr;
    CO_CANrx_t *rxArray;
    uint16_t rxSize;
    CO_CANtx_t *txArray;
    uint16_t txSize, CANerrorStatus;
    volatile bool_t CANnormal, useCANrxFilters, bufferInhibitFlag, firstCANtxMessage;
    volatile uint16_t CANtxCount;
    uint32_t errOld;
} CO_CANmodule_t;

typedef struct {
    void *addr;
    size_t len;
    uint8_t subIndexOD, attr;
    void *addrNV;
} CO_storage_entry_t;

#define CO_LOCK_CAN_SEND(module)
#define CO_UNLOCK_CAN_SEND(module)
#define CO_LOCK_EMCY(module)
#define CO_UNLOCK_EMCY(module)
#define CO_LOCK_OD(module)
#define CO_UNLOCK_OD(module)
#define CO_MemoryBarrier()
#define CO_FLAG_READ(rxNew) ((rxNew) != NULL)
#define CO_FLAG_SET(rxNew) { rxNew = (void *)1L; }
#define CO_FLAG_CLEAR(rxNew) { rxNew = NULL; }
#endif
