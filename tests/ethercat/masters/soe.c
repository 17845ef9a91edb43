/* The service channel by SOEM 1.4.0, as somebody else's master: reads and writes S-0-0130 and
   S-0-0169 of the first slave, and lets SOEM make its image of the telegrams.

   Argument: interface. Prints `key number...`, one line each; numbers are little endian values. */

#include <stdio.h>
#include <string.h>

#include "ethercat.h"

#define SLAVE 1
#define DRIVE 0

static char image[4096];

static void show(const char *key, int element, int number)
{
   uint8 data[256];
   int size = sizeof(data);
   memset(data, 0, sizeof(data));
   int counter = ec_SoEread(SLAVE, DRIVE, element, number, &size, data, EC_TIMEOUTRXM);
   printf("%s %d %d ", key, counter, size);
   for (int place = 0; place < size && place < 64; place++) printf("%02x", data[place]);
   printf("\n");
}

static void write_word(const char *key, int number, uint16 value)
{
   uint8 data[2] = {value & 0xFF, value >> 8};
   printf("%s %d\n", key,
          ec_SoEwrite(SLAVE, DRIVE, EC_SOE_VALUE_B, number, sizeof(data), data, EC_TIMEOUTRXM));
}

static void errors(const char *key)
{
   ec_errort error;
   int count = 0;
   uint16 last = 0;
   while (ec_poperror(&error))
   {
      count++;
      last = error.AbortCode & 0xFFFF;
   }
   printf("%s %d %04x\n", key, count, last);
}

int main(int count, char **words)
{
   setvbuf(stdout, NULL, _IOLBF, 0);
   if (count != 2 || !ec_init(words[1])) return 2;
   printf("slaves %d\n", ec_config_init(FALSE));
   printf("mailbox %d\n", ec_slave[SLAVE].mbx_proto);
   printf("preop %d\n", ec_statecheck(SLAVE, EC_STATE_PRE_OP, EC_TIMEOUTSTATE));
   show("name", EC_SOE_NAME_B, 169);
   show("attribute", EC_SOE_ATTRIBUTE_B, 130);
   show("probe", EC_SOE_VALUE_B, 130);
   show("control", EC_SOE_VALUE_B, 169);
   errors("before");
   write_word("write", 169, 1);
   show("control", EC_SOE_VALUE_B, 169);
   write_word("back", 169, 0);
   errors("between");
   write_word("refused", 130, 0); /* a measured value cannot be written */
   errors("after");
   show("nothing", EC_SOE_VALUE_B, 4000);
   errors("unknown");
   ec_config_map(image);
   printf("image %d %d\n", (int)ec_slave[SLAVE].Obits, (int)ec_slave[SLAVE].Ibits);
   printf("safeop %d\n", ec_statecheck(SLAVE, EC_STATE_SAFE_OP, EC_TIMEOUTSTATE));
   show("probe", EC_SOE_VALUE_B, 130);
   ec_close();
   return 0;
}
