// Reads volumes for the other programs, on standard input, which is a socket: started by them, not by people.

#include <cstdio>

#include <sys/socket.h>
#include <sys/types.h>
#include <unistd.h>

#include "core/volume_io/reader_process/reader_service.h"

int main() {
    int type = 0;
    socklen_t size = sizeof type;
    if (::getsockopt(STDIN_FILENO, SOL_SOCKET, SO_TYPE, &type, &size) != 0) {
        std::fputs("isoslider-reader: reads volumes for isoslider and isoslider-cli, which start it\n", stderr);
        return 2;
    }
    return isoslider::io::serveReader(STDIN_FILENO);
}
