/* The least a program can do that reads one object: one SDO request, one answer. usage: raw_read INTERFACE NODE */
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

int main(int argc, char **argv) {
  if (argc != 3) return 2;
  const unsigned node = (unsigned)atoi(argv[2]);
  const int bus = socket(PF_CAN, SOCK_RAW, CAN_RAW);
  const struct sockaddr_can address = {.can_family = AF_CAN, .can_ifindex = (int)if_nametoindex(argv[1])};
  if (bus < 0 || bind(bus, (const struct sockaddr *)&address, sizeof address) != 0) return 3;
  struct can_frame frame = {.can_id = 0x600 + node, .can_dlc = 8, .data = {0x40, 0x41, 0x60}};
  if (write(bus, &frame, sizeof frame) != sizeof frame) return 3;
  do
    if (read(bus, &frame, sizeof frame) != sizeof frame) return 3;
  while (frame.can_id != 0x580 + node);
  printf("0x%04X\n", frame.data[4] | frame.data[5] << 8);
  return 0;
}
