// Times U-Boot's Dhrystone 2.1 and checks what it leaves behind; ours, the benchmark is not.
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

void dhry(int runs);  // one run fewer

extern int Int_Glob, Bool_Glob, Arr_1_Glob[50], Arr_2_Glob[50][50];
extern char Ch_1_Glob, Ch_2_Glob;

int main(int argc, char** argv) {
  const int runs = argc > 1 ? atoi(argv[1]) : 100;
  const clock_t begin = clock();
  dhry(runs + 1);
  const clock_t end = clock();
  const int right = Int_Glob == 5 && Bool_Glob == 1 && Ch_1_Glob == 'A' && Ch_2_Glob == 'B' &&
                    Arr_1_Glob[8] == 7 && Arr_2_Glob[8][7] == runs + 10;
  printf("%d runs, final values as they should be: %s\n", runs, right ? "yes" : "no");
  printf("Dhrystones per second: %.1f\n", runs / ((end - begin) / (double)CLOCKS_PER_SEC));
  return right ? 0 : 1;
}
