/* One CANopenNode slave without threads: time and frames are arguments. */
#include "CANopen.h"
#include "OD.h"

static CO_t *node;
static uint8_t pending_id;
static void (*send_frame)(uint16_t ident, uint8_t length, const uint8_t *data);

void CO_CANsetConfigurationMode(void *port) { (void)port; }
void CO_CANsetNormalMode(CO_CANmodule_t *module) { module->CANnormal = true; }
void CO_CANmodule_disable(CO_CANmodule_t *module) { (void)module; }
void CO_CANmodule_process(CO_CANmodule_t *module) { (void)module; }
void CO_CANclearPendingSyncPDOs(CO_CANmodule_t *module) { (void)module; }

CO_ReturnError_t CO_CANmodule_init(CO_CANmodule_t *module, void *port, CO_CANrx_t rx[], uint16_t rx_size,
                                   CO_CANtx_t tx[], uint16_t tx_size, uint16_t bit_rate) {
    (void)bit_rate;
    *module = (CO_CANmodule_t){.CANptr = port, .rxArray = rx, .rxSize = rx_size, .txArray = tx, .txSize = tx_size};
    for (uint16_t i = 0; i < rx_size; i++) rx[i] = (CO_CANrx_t){.mask = 0xFFFF};
    for (uint16_t i = 0; i < tx_size; i++) tx[i].bufferFull = false;
    return CO_ERROR_NO;
}

CO_ReturnError_t CO_CANrxBufferInit(CO_CANmodule_t *module, uint16_t index, uint16_t ident, uint16_t mask, bool_t rtr,
                                    void *object, void (*callback)(void *object, void *message)) {
    if (module == NULL || object == NULL || callback == NULL || index >= module->rxSize) return CO_ERROR_ILLEGAL_ARGUMENT;
    module->rxArray[index] = (CO_CANrx_t){
        .ident = (ident & 0x7FF) | (rtr ? 0x800 : 0), .mask = (mask & 0x7FF) | 0x800, .object = object,
        .CANrx_callback = callback};
    return CO_ERROR_NO;
}

CO_CANtx_t *CO_CANtxBufferInit(CO_CANmodule_t *module, uint16_t index, uint16_t ident, bool_t rtr, uint8_t length,
                               bool_t sync) {
    if (module == NULL || index >= module->txSize || rtr) return NULL;
    CO_CANtx_t *buffer = &module->txArray[index];
    buffer->ident = ident & 0x7FF;
    buffer->DLC = length;
    buffer->bufferFull = false;
    buffer->syncFlag = sync;
    return buffer;
}

CO_ReturnError_t CO_CANsend(CO_CANmodule_t *module, CO_CANtx_t *buffer) {
    (void)module;
    send_frame((uint16_t)buffer->ident, buffer->DLC, buffer->data);
    return CO_ERROR_NO;
}

static int start(void) {
    uint32_t info = 0;
    CO_CANmodule_disable(node->CANmodule);
    CO_ReturnError_t error = CO_CANinit(node, &node, 1000);
    if (error == CO_ERROR_NO)
        error = CO_CANopenInit(node, NULL, NULL, OD, NULL, 0, 0, 1000, 0, false,
                               pending_id, &info);
    if (error == CO_ERROR_NO) error = CO_CANopenInitPDO(node, node->em, OD, pending_id, &info);
    if (error == CO_ERROR_NO) CO_CANsetNormalMode(node->CANmodule);
    return error == CO_ERROR_NO ? 0 : (int)error * 0x10000 - (int)info;
}

/* 0, or which call of the stack refused what */
int node_open(uint8_t node_id, void (*send)(uint16_t, uint8_t, const uint8_t *)) {
    send_frame = send;
    pending_id = node_id;
    node = CO_new(NULL, NULL);
    return node == NULL ? -1 : start();
}

void node_close(void) {
    if (node != NULL) CO_delete(node);
    node = NULL;
}

void node_receive(uint16_t ident, uint8_t length, const uint8_t *data, bool is_remote) {
    node_frame_t frame = {.ident = ident | (is_remote ? 0x800 : 0), .dlc = length};
    for (uint8_t i = 0; i < length && i < 8; i++) frame.data[i] = data[i];
    for (uint16_t i = 0; i < node->CANmodule->rxSize; i++) {
        CO_CANrx_t *buffer = &node->CANmodule->rxArray[i];
        if (buffer->CANrx_callback != NULL && ((frame.ident ^ buffer->ident) & buffer->mask) == 0) {
            buffer->CANrx_callback(buffer->object, &frame);
            return;
        }
    }
}

/* NMT, SDO, emergency, heartbeat; a reset that the master asked for is carried out */
int node_process(uint32_t passed_us) {
    CO_NMT_reset_cmd_t reset = CO_process(node, false, passed_us, NULL);
    return reset == CO_RESET_NOT ? 0 : start();
}

/* Take what the RPDOs brought; true when a SYNC has come */
bool node_take(uint32_t passed_us) {
    bool sync = CO_process_SYNC(node, passed_us, NULL);
    CO_process_RPDO(node, sync, passed_us, NULL);
    return sync;
}

void node_give(bool sync, uint32_t passed_us) { CO_process_TPDO(node, sync, passed_us, NULL); }

void node_error(bool is_set, uint8_t bit, uint16_t code, uint32_t info) { CO_error(node->em, is_set, bit, code, info); }

int node_nmt_state(void) { return (int)node->NMT->operatingState; }
